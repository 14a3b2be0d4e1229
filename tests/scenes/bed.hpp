// SPDX-License-Identifier: Apache-2.0
// Sea beds: heights above the plane z = 0, and meshes of them. Metres, world frame, z up.
#pragma once

#include <cmath>

#include "renderer/scene/world.hpp"

namespace sonard::test {

/// Height of the bed at (x, y).
using BedHeight = double (*)(double x_m, double y_m);

inline double flat_height_m(double /*x_m*/, double /*y_m*/) {
  return 0.0;
}

/// Waves with lengths of 7 by 9 m and a height of 0.6 m from trough to crest.
inline double swell_height_m(double x_m, double y_m) {
  return 0.3 * std::sin(0.9 * x_m) * std::cos(0.7 * y_m);
}

/// The swell with ripples of 0.9 by 1 m and 0.1 m height, which shadow each other everywhere at grazing
/// angles.
inline double ripple_height_m(double x_m, double y_m) {
  return swell_height_m(x_m, y_m) + 0.05 * std::sin(7 * x_m) * std::sin(6 * y_m);
}

/// The rectangle [west, east] x [south, north].
struct BedExtent {
  double west_m, east_m, south_m, north_m;
};

/// A mesh of 2 * cells_x * cells_y triangles with vertices on `height`. It has no normals, so facets are
/// flat.
render::TriangleMesh make_bed(const BedExtent& extent, int cells_x, int cells_y, BedHeight height);

}  // namespace sonard::test
