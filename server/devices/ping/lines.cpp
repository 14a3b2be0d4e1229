// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping/lines.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/asio/io_context.hpp>

#include "server/net/serial_transport.hpp"

namespace sonard::server {

std::vector<PlannedSocket> planned_sockets(const PingLines& lines) {
  std::vector<PlannedSocket> sockets = serial_sockets(lines.serial, "serial");
  for (std::size_t i = 0; i < lines.udp.size(); ++i) {
    sockets.push_back({PlannedSocket::Transport::udp, lines.udp[i].bind, fmt::format("udp[{}].bind", i)});
  }
  return sockets;
}

std::string lines_text(const PingLines& lines, bool has_serial) {
  std::vector<std::string> ways;
  for (const UdpTransportConfig& udp : lines.udp) {
    ways.push_back("UDP " + endpoint_text(udp.bind));
  }
  if (has_serial) {
    ways.push_back("serial by " + serial_text(lines.serial));
  }
  return fmt::format("{}", fmt::join(ways, ", "));
}

std::vector<std::unique_ptr<Transport>> open_transports(const PingLines& lines, bool has_serial,
                                                        boost::asio::io_context& io, const Clock& clock) {
  std::vector<std::unique_ptr<Transport>> transports;
  for (const UdpTransportConfig& udp : lines.udp) {
    transports.push_back(std::make_unique<UdpTransport>(io, clock, udp));
  }
  if (has_serial) {
    transports.push_back(std::make_unique<SerialTransport>(io, clock, lines.serial));
  }
  return transports;
}

}  // namespace sonard::server
