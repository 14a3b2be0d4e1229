#include "server/config/serial_section.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "server/config/addresses.hpp"
#include "server/config/head_section.hpp"

namespace sonard::server {
namespace {

constexpr std::string_view expected_endpoint = "an address and port such as 127.0.0.1:4001";

/// Socket is SerialTcpConfig or SerialUdpConfig.
template <typename Socket>
void read_sockets(YamlSection& section, std::string_view key, std::vector<Socket>& sockets) {
  section.sections(key, [&](YamlSection& inner) {
    Socket socket;
    inner.require("bind", expected_endpoint);
    inner.parsed("bind", socket.bind, &parse_endpoint, expected_endpoint);
    read_allow_list(inner, socket.bind.address, socket.allow);
    const bool taken = std::any_of(sockets.begin(), sockets.end(), [&](const Socket& other) {
      return other.bind == socket.bind && socket.bind.port != 0;
    });
    if (taken) {
      inner.report("bind", fmt::format("{} is given twice (expected a socket of its own)",
                                       endpoint_text(socket.bind)));
    }
    sockets.push_back(std::move(socket));
  });
}

void read_ptys(YamlSection& section, const std::filesystem::path& folder,
               std::vector<SerialPtyConfig>& ptys) {
  section.sections("pty", [&](YamlSection& inner) {
    SerialPtyConfig pty;
    std::string link;
    inner.text("link", link);
    if (!link.empty()) {
      pty.link = (folder / link).lexically_normal();
      const bool taken = std::any_of(ptys.begin(), ptys.end(),
                                     [&](const SerialPtyConfig& other) { return other.link == pty.link; });
      if (taken) {
        inner.report("link", fmt::format("{} is given twice (expected a name of its own)", link));
      }
    }
    ptys.push_back(std::move(pty));
  });
}

}  // namespace

SerialLinkConfig read_serial_link(YamlSection& section, const std::filesystem::path& folder) {
  SerialLinkConfig link;
  read_sockets(section, "tcp", link.tcp);
  read_sockets(section, "udp", link.udp);
  read_ptys(section, folder, link.pty);
  section.integer("baud", link.baud, 300, 4'000'000);
  if (link.tcp.empty() && link.udp.empty() && link.pty.empty()) {
    section.report("tcp",
                   "no client could reach the device (expected tcp, udp or pty with at least one item)");
  }
  return link;
}

}  // namespace sonard::server
