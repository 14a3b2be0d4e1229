// SPDX-License-Identifier: Apache-2.0
// Reads the section `poses` of the configuration.
#pragma once

#include <filesystem>
#include <span>

#include "server/pose/pose_config.hpp"
#include "server/pose/pose_input.hpp"
#include "server/yaml/yaml_section.hpp"

namespace sonard::server {

/// @param types the permitted types of sources
/// @param folder of the configuration file
PoseConfig read_poses(YamlSection& section, std::span<const PoseSourceType* const> types,
                      const std::filesystem::path& folder);

}  // namespace sonard::server
