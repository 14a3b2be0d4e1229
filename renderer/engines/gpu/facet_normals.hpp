// SPDX-License-Identifier: Apache-2.0
// Normals of facets for shaders that are to know them exactly.
#pragma once

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// The same triangles, in which the last corner of each carries the normal of the facet: the value that
/// OpenGL takes for a `flat` input. A corner carries one; where all three of a triangle are taken, one is
/// added. So there are hardly more corners than triangles. What the other corners carry is of no use, nor are
/// the old normals.
TriangleMesh with_facet_normals(const TriangleMesh& mesh);

}  // namespace sonard::render
