// SPDX-License-Identifier: Apache-2.0
// Tests whether a socket can be bound.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/net/planned_socket.hpp"

namespace sonard::server {

/// Binds the socket for a moment. @return why it cannot be bound; nullopt if it can
std::optional<std::string> obstacle_to_binding(const PlannedSocket& planned);

/// Addresses and ports that this process receives on now: bound UDP sockets and listening TCP sockets, IPv4.
/// Their `key` is empty.
std::vector<PlannedSocket> own_sockets();

}  // namespace sonard::server
