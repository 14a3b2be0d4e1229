// SPDX-License-Identifier: Apache-2.0
// OpenSceneGraph's libraries for single formats.
#pragma once

#include <filesystem>

namespace sonard::render {

/// Loads what OpenSceneGraph needs for files of this extension, before the process is confined and can load
/// no library any more.
void load_osg_plugin(const std::filesystem::path& file);

}  // namespace sonard::render
