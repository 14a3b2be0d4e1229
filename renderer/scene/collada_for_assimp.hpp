// SPDX-License-Identifier: Apache-2.0
// COLLADA documents that Assimp reads otherwise than Gazebo, or not at all, written so that both agree.
#pragma once

#include <string>

namespace sonard::render {

/// The document with these changes; unchanged if it needs none, or if it is not well-formed XML.
/// - Values of a mesh's accessor are x, y, z in their order. Gazebo ignores the names of <param>; Assimp
/// takes
///   all values for the first one if the names are missing or in lower case.
/// - The transforms of a node are in the order of Gazebo: one <matrix> alone, else translate, rotate, scale.
/// - A picture without a file name gets one, because Assimp 5.2 crashes without it.
std::string collada_for_assimp(std::string document);

}  // namespace sonard::render
