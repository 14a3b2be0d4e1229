// SPDX-License-Identifier: Apache-2.0
// Reads the section `recording` of the configuration.
#pragma once

#include <filesystem>

#include "server/recording/recording_config.hpp"
#include "server/yaml/yaml_section.hpp"

namespace sonard::server {

/// @param folder of the configuration file
RecordingConfig read_recording(YamlSection& section, const std::filesystem::path& folder);

}  // namespace sonard::server
