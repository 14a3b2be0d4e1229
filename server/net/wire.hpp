// SPDX-License-Identifier: Apache-2.0
// Bytes that passed between a head and its clients, for a recording.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/common/endpoint.hpp"
#include "protocol/common/shared_bytes.hpp"

namespace sonard::server {

enum class WireTransport : std::uint8_t { udp, tcp, pty };

/// The two ends of a wire. A pseudo terminal has no addresses.
struct WireEnds {
  WireTransport transport = WireTransport::udp;
  Endpoint client;
  Endpoint head;
  std::string pty;  ///< path of the slave
};

struct WirePiece {
  Endpoint client;
  Endpoint head;
  SharedBytes bytes;
};

/// Datagrams, or pieces of a stream, that passed the socket in one call.
struct WirePassed {
  bool to_client = false;
  WireTransport transport = WireTransport::udp;
  std::string pty;  ///< path of the slave
  std::vector<WirePiece> pieces;
};

}  // namespace sonard::server
