// SPDX-License-Identifier: Apache-2.0
// Turns the triangles of a file or a shape into a valid TriangleMesh for the samplers.
#pragma once

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Checks and repairs a mesh. Triangles are dropped if they have a repeated corner, no area, or a coordinate
/// that is not finite or beyond 1e12 m; then unused vertices are dropped. Normals become unit. A normal that
/// is zero or not finite becomes the area-weighted geometric normal of the triangles around it. Texture
/// coordinates that are not finite become 0. `diagnostics` counts all repairs.
/// @throws WorldError if an index is out of range or an attribute array has the wrong length.
TriangleMesh validated_mesh(TriangleMesh mesh, MeshDiagnostics& diagnostics);

/// Fills `tangents`: the direction in which texture coordinate u grows on the surface, perpendicular to the
/// normal. A mesh without normals gets flat ones first. Vertices shared by triangles of opposite handedness
/// (a texture mirrored at a seam) are doubled. If the texture coordinates are constant, the tangent is any
/// direction along the surface.
/// @pre `mesh` is validated and has texture coordinates.
void add_tangents(TriangleMesh& mesh);

}  // namespace sonard::render
