// SPDX-License-Identifier: Apache-2.0
// Layout table of a packet's header. Payload and checksum follow it. Source: protocol/sonar3d15/README.md 1.
#pragma once

#include <tuple>

#include "protocol/common/layout.hpp"
#include "protocol/sonar3d15/packet.hpp"

namespace sonard::sonar3d15 {

struct PacketLayout : WholeLayout<packet_header_size> {
  static constexpr auto fields = std::tuple{
      Field{0, "id", &PacketHeader::id},
      Field{4, "length", &PacketHeader::length},
  };
};

}  // namespace sonard::sonar3d15
