// SPDX-License-Identifier: Apache-2.0
// A Ping360 on its sockets and its serial line.
#pragma once

#include <memory>

#include "server/devices/device_type.hpp"

namespace sonard::server {

/// @throws SocketError
std::unique_ptr<ConnectedDevice> connect_ping360(const HeadConfig& head, boost::asio::io_context& io,
                                                 const Clock& clock);

}  // namespace sonard::server
