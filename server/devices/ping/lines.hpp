// SPDX-License-Identifier: Apache-2.0
// How clients reach a head of the Ping protocol: UDP sockets and at most one serial line.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/heads/device_settings.hpp"
#include "server/heads/head_type.hpp"
#include "server/net/serial_port.hpp"
#include "server/net/transport.hpp"
#include "server/net/udp_transport.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::server {

struct PingLines {
  std::vector<UdpTransportConfig> udp;  ///< channels 0, 1, ... of the device; all have the faults of one link
  /// The channel after the UDP channels; without tcp, udp and pty there is no serial line.
  SerialLinkConfig serial;
};

/// The part of a configuration that only a head with this device has.
template <class DeviceConfig>
struct PingHeadConfig : DeviceSettings, PingLines {
  DeviceConfig device;
};

std::vector<PlannedSocket> planned_sockets(const PingLines& lines);
/// "UDP 127.0.0.1:9090, serial by pty"; without `has_serial` there is no serial line.
std::string lines_text(const PingLines& lines, bool has_serial);
/// The transport of each channel, in their order. @throws SocketError
std::vector<std::unique_ptr<Transport>> open_transports(const PingLines& lines, bool has_serial,
                                                        boost::asio::io_context& io, const Clock& clock);

}  // namespace sonard::server
