// SPDX-License-Identifier: Apache-2.0
// How far Gazebo's transport reaches, which opens its sockets by itself and once in a process.
#pragma once

#include "protocol/common/endpoint.hpp"

namespace sonard::server {

/// Call it before the first node: the library then joins discovery on the interface with this address, and
/// listens there by TCP.
/// @throws PoseSourceError for an address that this machine does not have, with which the library would take
///   another one
void set_ignition_address(Ipv4 address);

/// Call it after the first node. The library receives discovery on all addresses, whatever its address is.
/// From now on these sockets drop all datagrams of other machines.
/// @throws PoseSourceError
void keep_ignition_to_this_machine();

}  // namespace sonard::server
