// SPDX-License-Identifier: Apache-2.0
// A Gemini on its socket.
#pragma once

#include <memory>

#include "server/devices/device_type.hpp"

namespace sonard::server {

/// @throws SocketError
std::unique_ptr<ConnectedDevice> connect_gemini(const HeadConfig& head, boost::asio::io_context& io,
                                                const Clock& clock);

}  // namespace sonard::server
