// SPDX-License-Identifier: Apache-2.0
// Limits the reach of Gazebo's transport, which opens its sockets by itself, once per process.
#pragma once

#include "protocol/common/endpoint.hpp"

namespace sonard::server {

/// Call it before the first node: the library then joins discovery on the interface with this address, and
/// listens there on TCP.
/// @throws Error if this machine does not have the address; the library would use another one
void set_gazebo_address(Ipv4 address);

/// Call it after the first node. The library receives discovery on all addresses, whatever its own address.
/// From now on these sockets drop all datagrams of other machines.
/// @throws Error
void keep_gazebo_to_this_machine();

}  // namespace sonard::server
