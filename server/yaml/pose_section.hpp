// SPDX-License-Identifier: Apache-2.0
// Reads a pose.
#pragma once

#include <string_view>

#include "renderer/pose.hpp"
#include "server/yaml/yaml_section.hpp"

namespace sonard::server {

/// `position_m` and `rpy_deg` (roll, pitch, yaw about fixed x, y, z; positive pitch is nose down), each
/// with its meaning.
void read_pose(YamlSection& section, render::Pose& pose, std::string_view position_meaning,
               std::string_view rpy_meaning);

}  // namespace sonard::server
