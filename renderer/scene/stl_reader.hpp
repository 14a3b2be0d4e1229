// SPDX-License-Identifier: Apache-2.0
// STL files. The libraries tell text from binary by the first five bytes, refuse keywords in capitals and
// read what is there of a file that is cut short.
#pragma once

#include <filesystem>
#include <string>

#include "renderer/scene/raw_mesh.hpp"

namespace sonard::render {

/// Reads a file of 84 + 50 n bytes as binary, n being the triangle count of its header, and a file that
/// begins with "solid" (letter case and blanks before it ignored) as text. A text file may hold several
/// solids; with a `submesh` only the solids of that name are taken. Normals are not read: they say no more
/// than the triangles.
/// @throws std::runtime_error naming the line of a text, or the sizes of a binary file that is cut short.
RawMesh read_stl(const std::filesystem::path& file, const std::string& submesh);

}  // namespace sonard::render
