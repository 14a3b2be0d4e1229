// SPDX-License-Identifier: Apache-2.0
// One ping of a head, from the head to the renderer.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "renderer/ping.hpp"
#include "server/pose/poses_used.hpp"

namespace sonard::server {

struct PosedPing {
  int head = 0;                   ///< its index, 0, 1, 2, ...
  std::uint64_t transmit_us = 0;  ///< transmit time on the clock of the head, for dumps
  render::PingRequest request;
  /// Of the ping: the bodies are moved before it is rendered. Not null.
  std::shared_ptr<const PosesUsed> poses = std::make_shared<const PosesUsed>();
  std::string hidden_body{};  ///< moved out of sight before it is rendered; empty: none
};

}  // namespace sonard::server
