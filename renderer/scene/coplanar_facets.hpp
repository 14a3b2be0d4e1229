// SPDX-License-Identifier: Apache-2.0
// Large flat surfaces in few triangles, however finely they were modelled.
#pragma once

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// The surface of `mesh` in fewer triangles: vertices inside a plane, on a straight edge between two planes
/// or on a straight border are taken out. Positions only; what is left keeps its winding and its order.
/// Facets count as one plane where corners and normals are within `flat_m` and `flat_rad` of the plane of one
/// of them, so that nothing moves farther than that, and the mesh stays as tight as it was.
TriangleMesh merge_coplanar_facets(const TriangleMesh& mesh);

inline constexpr double flat_rad = 1e-4;
inline constexpr double flat_m = 2e-5;  ///< beside the rounding of the positions themselves

}  // namespace sonard::render
