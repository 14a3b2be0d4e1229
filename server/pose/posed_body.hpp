// SPDX-License-Identifier: Apache-2.0
// A body of the world with its pose.
#pragma once

#include <string>

#include "renderer/pose.hpp"

namespace sonard::server {

struct PosedBody {
  std::string name;
  render::Pose T_world_body;

  bool operator==(const PosedBody&) const = default;
};

}  // namespace sonard::server
