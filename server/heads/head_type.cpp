// SPDX-License-Identifier: Apache-2.0
#include "server/heads/head_type.hpp"

#include <cstddef>

#include <fmt/format.h>

namespace sonard::server {

std::vector<PlannedSocket> serial_sockets(const SerialLinkConfig& link, const std::string& key) {
  std::vector<PlannedSocket> sockets;
  for (std::size_t i = 0; i < link.udp.size(); ++i) {
    sockets.push_back(
        {PlannedSocket::Transport::udp, link.udp[i].bind, fmt::format("{}.udp[{}].bind", key, i)});
  }
  for (std::size_t i = 0; i < link.tcp.size(); ++i) {
    sockets.push_back(
        {PlannedSocket::Transport::tcp, link.tcp[i].bind, fmt::format("{}.tcp[{}].bind", key, i)});
  }
  return sockets;
}

std::vector<Identity> serial_identities(const SerialLinkConfig& link, const std::string& key) {
  std::vector<Identity> identities;
  for (const SerialPtyConfig& pty : link.pty) {
    if (!pty.link.empty()) {
      identities.push_back({key + ".pty", "'" + pty.link.string() + "'", false});
    }
  }
  return identities;
}

}  // namespace sonard::server
