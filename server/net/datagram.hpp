// SPDX-License-Identifier: Apache-2.0
// A datagram between a head and a client, with both addresses.
#pragma once

#include "protocol/common/endpoint.hpp"
#include "protocol/common/shared_bytes.hpp"

namespace sonard::server {

struct Datagram {
  Endpoint remote;  ///< destination or source
  /// Our address: its destination, or the source to use. 0: the kernel chooses by its routes.
  Ipv4 local = 0;
  SharedBytes bytes;
};

}  // namespace sonard::server
