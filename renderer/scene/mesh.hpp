// SPDX-License-Identifier: Apache-2.0
// What turns the triangles of a file or a shape into a TriangleMesh that the samplers can trust.
#pragma once

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Checks and repairs a mesh: triangles with a repeated corner, no area or a coordinate that is not finite
/// (or beyond 1e12 m) are dropped and vertices that no triangle uses any more with them; normals are made
/// unit, and one that is zero or not finite becomes the area-weighted geometric normal of the triangles
/// around it; texture coordinates that are not finite become 0. Everything repaired is counted in
/// `diagnostics`.
/// @throws WorldError when an index is out of range or an attribute array has the wrong length.
TriangleMesh validated_mesh(TriangleMesh mesh, MeshDiagnostics& diagnostics);

/// Fills `tangents`, the direction in which texture coordinate u grows on the surface, made perpendicular to
/// the normal. A mesh without normals gets flat ones first. Vertices shared by triangles of opposite
/// handedness (a texture mirrored at a seam) are doubled. Where the texture coordinates do not change, the
/// tangent is any direction along the surface.
/// @pre `mesh` is validated and has texture coordinates.
void add_tangents(TriangleMesh& mesh);

}  // namespace sonard::render
