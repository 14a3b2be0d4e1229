// SPDX-License-Identifier: Apache-2.0
#include "server/yaml/network_section.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "server/net/addresses.hpp"

namespace sonard::server {
namespace {

constexpr TextForm serial_endpoint_form{"an address and port such as 127.0.0.1:4001", endpoint_form.type,
                                        endpoint_form.schema, true};

/// Socket is SerialTcpConfig or SerialUdpConfig.
template <typename Socket>
void read_sockets(YamlSection& section, std::string_view key, std::vector<Socket>& sockets,
                  std::string_view meaning) {
  section.sections(key, meaning, [&](YamlSection& inner) {
    Socket socket;
    read_socket(inner, socket.bind, socket.allow, serial_endpoint_form,
                "address that clients connect or send to", "clients, at most 16 connections");
    report_if_taken(inner, socket.bind, sockets);
    sockets.push_back(std::move(socket));
  });
  section.default_is(key, "[]", "[]");
}

void read_ptys(YamlSection& section, const std::filesystem::path& folder,
               std::vector<SerialPtyConfig>& ptys) {
  const auto read_pty = [&](YamlSection& inner) {
    SerialPtyConfig pty;
    inner.path(
        "link", pty.link, folder,
        "symbolic link to the pseudo terminal, whose own name (such as `/dev/pts/3`) is new at each start. "
        "sonard replaces only a link that leads to a pseudo terminal, and removes its link when it ends");
    pty.link = pty.link.lexically_normal();
    const bool taken = std::any_of(ptys.begin(), ptys.end(), [&](const SerialPtyConfig& other) {
      return other.link == pty.link && !pty.link.empty();
    });
    if (taken) {
      inner.report("link", fmt::format("{} is given twice (expected a different link for each item)",
                                       pty.link.string()));
    }
    ptys.push_back(std::move(pty));
  };
  section.sections("pty", "pseudo terminals, like serial devices; `- {}` is one without a link", read_pty);
  section.default_is("pty", "[]", "[]");
}

void read_faults(YamlSection& section, LinkFaults& faults) {
  constexpr Range probability = Range::from(0.0, 1.0);
  constexpr Range up_to_a_minute = Range::from(0.0, 60'000.0);
  section.number("loss", faults.loss, probability, "probability that a datagram is lost");
  section.number("duplicate", faults.duplicate, probability, "probability that a datagram arrives twice");
  section.number("reorder", faults.reorder, probability,
                 "probability that the next datagram overtakes a datagram");
  section.duration("delay_ms", faults.delay, up_to_a_minute, "delay added to each datagram");
  section.duration("jitter_ms", faults.jitter, up_to_a_minute,
                   "maximum of the random extra delay, drawn for each datagram");
}

}  // namespace

void read_allow_list(YamlSection& section, Ipv4 bind_address, AllowList& allow, std::string_view meaning) {
  if (is_loopback(bind_address)) {
    allow = {{0x7F000000, 8}};
  } else if (bind_address != 0 || section.has("bind")) {  // otherwise the address was rejected before
    section.require("allow", "the address blocks to serve, because the socket is not bound to loopback");
  }
  constexpr TextForm blocks{"an address block such as 10.61.19.0/24", "address blocks",
                            R"("type": "string", "pattern": "^[0-9]{1,3}(\\.[0-9]{1,3}){3}(/[0-9]{1,2})?$")"};
  section.parsed_list("allow", allow, &parse_cidr, blocks, meaning,
                      "the list is empty (expected at least one address block)");
  section.default_is("allow", "loopback; otherwise **required**", R"(["127.0.0.0/8"])");
}

void read_socket(YamlSection& section, Endpoint& bind, AllowList& allow, const TextForm& form,
                 std::string_view bind_meaning, std::string_view allow_meaning) {
  section.require("bind", form.expected);
  constexpr Ipv4 loopback = 0x7F000001;  // for a rejected address: then `allow` is not required
  const bool stands = section.parsed("bind", bind, &parse_endpoint, form, bind_meaning);
  read_allow_list(section, stands ? bind.address : loopback, allow, allow_meaning);
}

SerialLinkConfig read_serial_link(YamlSection& section, const std::filesystem::path& folder) {
  section.introduce(
      "At least one of `tcp`, `udp` and `pty` is required, with any number of entries. Every client receives "
      "every frame.");
  SerialLinkConfig link;
  read_sockets(section, "tcp", link.tcp,
               "TCP ports with raw bytes, as serial device servers; no telnet, no RFC 2217");
  read_sockets(section, "udp", link.udp,
               "UDP ports with one datagram for each frame, to the peer that sent last");
  read_ptys(section, folder, link.pty);
  section.integer("baud", link.baud, 300, 4'000'000,
                  "simulated speed of the line in bits per second, with ten bits per byte. A head keeps its "
                  "pace without this key. At 115200, a frame of 445 bytes arrives 38.6 ms after it was sent");
  section.default_is("baud", "no limit");
  if (link.tcp.empty() && link.udp.empty() && link.pty.empty()) {
    section.report("tcp",
                   "no client could reach the device (expected tcp, udp or pty with at least one item)");
  }
  return link;
}

void read_lock_to_first(YamlSection& section, bool& lock_to_first, std::string_view free_again) {
  section.choice("lock_to_first", lock_to_first, {{"off", false}, {"on", true}},
                 fmt::format("`on`: the first address that sends commands controls the head. Others are "
                             "dropped until {} ([security.md](security.md))",
                             free_again));
}

void read_link_faults(YamlSection& section, LinkConfig& link) {
  section.introduce("The same seed and traffic give the same faults.");
  section.integer("seed", link.seed, 0, std::numeric_limits<std::uint64_t>::max(), "seed of the faults");
  section.renamed("to_surface", "to_client");
  section.section("to_client", "faults of datagrams that the head sends",
                  [&](YamlSection& inner) { read_faults(inner, link.to_client); });
  section.renamed("from_surface", "from_client");
  section.section("from_client", "faults of datagrams that the head receives",
                  [&](YamlSection& inner) { read_faults(inner, link.from_client); });
}

}  // namespace sonard::server
