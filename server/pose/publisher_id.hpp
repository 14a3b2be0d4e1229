// SPDX-License-Identifier: Apache-2.0
// The sender of poses.
#pragma once

#include <compare>
#include <cstdint>
#include <string>

#include "protocol/common/endpoint.hpp"

namespace sonard::server {

/// Identifies a publisher among the publishers of one source.
struct PublisherId {
  Endpoint endpoint;
  /// MAVLink IDs; 0: the publisher uses another protocol.
  std::uint8_t system_id = 0, component_id = 0;

  /// By endpoint, then IDs.
  auto operator<=>(const PublisherId&) const = default;
};

/// For people: "127.0.0.1:41234", "127.0.0.1:41234 system 1 component 1".
std::string to_string(const PublisherId& publisher);

}  // namespace sonard::server
