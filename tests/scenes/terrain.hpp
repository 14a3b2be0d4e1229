// SPDX-License-Identifier: Apache-2.0
// Ground with relief of all lengths, as in surveys, and heightmaps of it.
#pragma once

#include "renderer/scene/image_file.hpp"

namespace sonard::test {

/// Side of the square ground around the origin, and upper limit of the height above its lowest possible
/// point.
inline constexpr double ground_side_m = 100.0;
inline constexpr double ground_relief_m = 12.0;

/// Height of the ground above its lowest possible point. It is a sum of waves with lengths from 100 m to 0.1
/// m, each in another direction. A wave of length L has 2 m (L / 100 m)^1.3 from trough to crest: 10 cm at 10
/// m, half a centimetre at 1 m.
double ground_height_m(double x_m, double y_m);

/// The ground as a heightmap of `side_px` by `side_px` pixels. White is ground_relief_m. The pixel at the far
/// corner is set to white, so that the image's maximum is white.
render::GreyImage ground_picture(int side_px);

}  // namespace sonard::test
