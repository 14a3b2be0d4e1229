// SPDX-License-Identifier: Apache-2.0
// Merges the facets of large flat surfaces into few triangles.
#pragma once

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// The surface of `mesh` in fewer triangles: without vertices inside a plane, on a straight edge between two
/// planes or on a straight border. Positions only; the remaining triangles keep winding and order. Facets
/// count as one plane if corners and normals are within `flat_m` and `flat_rad` of the plane of one of them.
/// Nothing moves farther than that, and a closed mesh stays closed.
TriangleMesh merge_coplanar_facets(const TriangleMesh& mesh);

inline constexpr double flat_rad = 1e-4;
inline constexpr double flat_m = 2e-5;  ///< in addition to the rounding of positions

}  // namespace sonard::render
