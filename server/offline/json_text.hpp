// SPDX-License-Identifier: Apache-2.0
// Values as JSON. The same values give the same text everywhere.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "renderer/pose.hpp"

namespace sonard::server {

/// With its quotes; control characters, quotes and backslashes escaped.
std::string json_string(std::string_view text);
/// "[1, 2.5]", each number in the shortest form that reads back the same. They are finite.
std::string json_list(const std::vector<double>& numbers);
/// An object of `position_m` and `quaternion_xyzw`.
std::string json_pose(const render::Pose& pose);

}  // namespace sonard::server
