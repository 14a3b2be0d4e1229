// SPDX-License-Identifier: Apache-2.0
// OpenSceneGraph's plugins for file formats.
#pragma once

#include <filesystem>

namespace sonard::render {

/// Loads OpenSceneGraph's libraries for this extension. Call it before the process is confined, which
/// prevents loading libraries.
void load_osg_plugin(const std::filesystem::path& file);

}  // namespace sonard::render
