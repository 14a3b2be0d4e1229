// SPDX-License-Identifier: Apache-2.0
// Ground with relief of all lengths, as surveys find it, and heightmaps of it.
#pragma once

#include "renderer/scene/image_file.hpp"

namespace sonard::test {

/// Side of the square ground around the origin, and the largest height above its lowest point that it may
/// have.
inline constexpr double ground_side_m = 100.0;
inline constexpr double ground_relief_m = 12.0;

/// Height of the ground over the lowest point that it may have. Waves of lengths from 100 m down to 0.1 m,
/// each in a direction of its own; from trough to crest a wave of length L is 2 m (L / 100 m)^1.3: 10 cm at
/// 10 m, half a centimetre at 1 m.
double ground_height_m(double x_m, double y_m);

/// The ground as a heightmap of `side_px` by `side_px` pixels: white is ground_relief_m, and one pixel at the
/// far corner is white so that this is the brightest.
render::GreyImage ground_picture(int side_px);

}  // namespace sonard::test
