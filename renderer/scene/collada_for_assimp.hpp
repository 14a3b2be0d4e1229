// SPDX-License-Identifier: Apache-2.0
// Rewrites COLLADA documents that Assimp reads differently from Gazebo, or not at all, so that both agree.
#pragma once

#include <string>
#include <vector>

namespace sonard::render {

/// Returns the document with these changes; one that is not well-formed XML stays as it is.
/// - Text in UTF-16 becomes UTF-8.
/// - Values of a mesh's accessor are x, y, z in this order. Gazebo ignores the names of <param>. Assimp
/// treats all values as the first one if the names are missing or in lower case.
/// - The transforms of a node are in Gazebo's order: one <matrix> alone, else translate, rotate, scale.
/// - The axis of a <rotate> has length 1; an axis of zeros does not turn.
/// - Animations, pictures and effects are empty, because Assimp refuses some that are valid, and crashes on a
/// picture without a file name. The effects themselves remain: Assimp forgets a material whose effect is
/// missing.
/// - Instead of skins and morphs, nodes have their meshes, in the pose that is stored. Assimp crashes on some
/// skins.
/// - Words of a <float_array> that are not numbers ("1.#QNAN") become NaN. Assimp stops at them.
/// - If an index of normals or texture coordinates has no value, the surface loses these, with a warning.
/// @param warnings without the name of the file
/// @throws std::runtime_error with the line, if <float_array>, <triangles> or <polylist> hold less than their
/// `count`, or if an index is not a whole number, or has no vertex (COLLADA 1.4.1, 5 and 6)
std::string collada_for_assimp(std::string document, std::vector<std::string>& warnings);

}  // namespace sonard::render
