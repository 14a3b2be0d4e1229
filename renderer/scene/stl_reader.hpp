// SPDX-License-Identifier: Apache-2.0
// STL files. The libraries distinguish text from binary by the first five bytes, refuse keywords in capitals
// and read truncated files without an error.
#pragma once

#include "renderer/scene/raw_mesh.hpp"

namespace sonard::render {

/// Reads a file of 84 + 50 n bytes as binary, where n is the triangle count of its header. A file that begins
/// with "solid" (ignoring letter case and leading blanks) is text. A text file may hold several solids; with
/// a submesh only the solids of that name are read. Normals are skipped, because they follow from the
/// triangles.
/// @throws std::runtime_error with the line of a text, or the sizes of a truncated binary file.
RawMesh read_stl(const MeshSource& source);

}  // namespace sonard::render
