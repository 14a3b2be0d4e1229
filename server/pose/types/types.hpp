// SPDX-License-Identifier: Apache-2.0
// All types of pose sources in this program.
#pragma once

#include <span>

#include "server/pose/pose_input.hpp"

namespace sonard::server {

/// In the order of SONARD_POSE_SOURCES in server/pose/CMakeLists.txt; the build writes this function.
std::span<const PoseSourceType* const> pose_source_types();

}  // namespace sonard::server
