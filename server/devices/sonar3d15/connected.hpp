// SPDX-License-Identifier: Apache-2.0
// A Sonar 3D-15 on its sockets.
#pragma once

#include <memory>

#include "server/devices/device_type.hpp"

namespace sonard::server {

/// @throws SocketError
std::unique_ptr<ConnectedDevice> connect_sonar3d15(const HeadConfig& head, boost::asio::io_context& io,
                                                   const Clock& clock);

}  // namespace sonard::server
