// SPDX-License-Identifier: Apache-2.0
// A datagram between a head and the other end, with both ends named.
#pragma once

#include "protocol/common/endpoint.hpp"
#include "protocol/common/shared_bytes.hpp"

namespace sonard::server {

struct Datagram {
  Endpoint remote;  ///< where it goes to or came from
  /// Our address: the one it was sent to, or the one it shall come from. 0: the kernel chooses by its routes.
  Ipv4 local = 0;
  SharedBytes bytes;
};

}  // namespace sonard::server
