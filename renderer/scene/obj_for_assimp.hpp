// SPDX-License-Identifier: Apache-2.0
// Rewrites OBJ files that Assimp reads wrongly, or not at all, in the form that it reads.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sonard::render {

struct ObjForAssimp {
  std::string text;
  std::vector<std::string> warnings;  ///< without the name of the file
  bool has_faces = false;             ///< Assimp stops at a file without one
};

/// Keeps the lines that triangles and their names need (v, vt, vn, f, o, g, usemtl) with these changes:
/// - No comments after numbers, no continued lines, no blanks before keywords, no mark of UTF-8.
/// - Each number begins with a digit or a minus sign. Assimp drops a vertex with a number like ".5", and all
/// later indices then mean other vertices.
/// - v and vn have three numbers, vt has two. The weight and the colour of a vertex are left out.
/// - A bad vt or vn, or a corner of a face that lacks one, has zeros, with a warning. Assimp stops, or drops
/// all of the object.
/// - Indices count from the first vertex. Faces of fewer than three corners are left out.
/// - Faces before the first usemtl have Assimp's default material. Assimp gives them the next one.
/// - mtllib is left out, so Assimp opens no other file: usemtl is enough for the names.
/// @throws std::runtime_error with the line of a bad vertex, or of a face with a vertex that does not exist
ObjForAssimp obj_for_assimp(std::string_view document);

}  // namespace sonard::render
