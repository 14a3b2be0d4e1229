// SPDX-License-Identifier: Apache-2.0
#include "server/config/network_section.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "server/net/addresses.hpp"

namespace sonard::server {
namespace {

constexpr std::string_view expected_serial_endpoint = "an address and port such as 127.0.0.1:4001";

/// Socket is SerialTcpConfig or SerialUdpConfig.
template <typename Socket>
void read_sockets(YamlSection& section, std::string_view key, std::vector<Socket>& sockets) {
  section.sections(key, [&](YamlSection& inner) {
    Socket socket;
    inner.require("bind", expected_serial_endpoint);
    inner.parsed("bind", socket.bind, &parse_endpoint, expected_serial_endpoint);
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

void read_faults(YamlSection& section, LinkFaults& faults) {
  constexpr Range probability = Range::from(0.0, 1.0);
  constexpr double minute_ms = 60'000.0;
  section.number("loss", faults.loss, probability);
  section.number("duplicate", faults.duplicate, probability);
  section.number("reorder", faults.reorder, probability);
  section.duration("delay_ms", faults.delay, Range::from(0.0, minute_ms));
  section.duration("jitter_ms", faults.jitter, Range::from(0.0, minute_ms));
}

}  // namespace

void read_allow_list(YamlSection& section, Ipv4 bind_address, AllowList& allow) {
  constexpr std::string_view expected = "an address block such as 10.61.19.0/24";
  if (is_loopback(bind_address)) {
    allow = {{0x7F000000, 8}};
  } else if (bind_address != 0 || section.has("bind")) {  // otherwise the address itself was refused
    section.require("allow", "the address blocks to serve, as the socket is not bound to loopback");
  }
  section.parsed_list("allow", allow, &parse_cidr, expected);
  if (section.is_list("allow") && allow.empty()) {
    section.report("allow", "nobody is listed (expected at least one address block)");
  }
}

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

void read_link_faults(YamlSection& section, LinkConfig& link) {
  section.integer("seed", link.seed, 0, std::numeric_limits<std::uint64_t>::max());
  section.section("to_surface", [&](YamlSection& inner) { read_faults(inner, link.to_client); });
  section.section("from_surface", [&](YamlSection& inner) { read_faults(inner, link.from_client); });
}

}  // namespace sonard::server
