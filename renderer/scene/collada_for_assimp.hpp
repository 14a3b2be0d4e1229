// SPDX-License-Identifier: Apache-2.0
// Rewrites COLLADA documents that Assimp reads differently from Gazebo, or not at all, so that both agree.
#pragma once

#include <string>

namespace sonard::render {

/// Returns the document with these changes; unchanged if it needs none, or if it is not well-formed XML.
/// - Values of a mesh's accessor are x, y, z in this order. Gazebo ignores the names of <param>. Assimp
/// treats all values as the first one if the names are missing or in lower case.
/// - The transforms of a node are in Gazebo's order: one <matrix> alone, else translate, rotate, scale.
/// - The axis of a <rotate> has length 1; an axis of zeros does not turn.
/// - Pictures and effects are empty, because Assimp refuses some that are valid, and crashes on a picture
/// without a file name. The effects themselves remain: Assimp forgets a material whose effect is missing.
std::string collada_for_assimp(std::string document);

}  // namespace sonard::render
