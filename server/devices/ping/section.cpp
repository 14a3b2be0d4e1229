// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping/section.hpp"

#include <fmt/format.h>

#include "server/yaml/network_section.hpp"

namespace sonard::server {
namespace {

void read_udp(YamlSection& section, std::string_view meaning, const LinkConfig& link, PingLines& lines) {
  const auto read = [&](YamlSection& inner) {
    UdpTransportConfig socket;
    read_socket(inner, socket.bind, socket.allow, endpoint_form, meaning,
                "address blocks that the head answers");
    report_if_taken(inner, socket.bind, lines.udp);
    socket.link = link;
    lines.udp.push_back(std::move(socket));
  };
  section.sections("udp", "sockets that clients send to; required without `serial`", read);
}

}  // namespace

void read_lines(YamlSection& section, const HeadContext& context, std::string_view udp_meaning,
                PingLines& lines, ping::ClientsConfig& clients) {
  LinkConfig link;
  section.section("link", "faults of the datagrams of `udp`",
                  [&](YamlSection& inner) { read_link_faults(inner, link); });
  read_udp(section, udp_meaning, link, lines);
  section.section("serial", "serial line in addition to the sockets",
                  [&](YamlSection& inner) { lines.serial = read_serial_link(inner, context.folder); });
  if (section.has("serial")) {
    clients.serial_channel = static_cast<int>(lines.udp.size());
  } else if (lines.udp.empty()) {
    section.report("udp", "no client could reach the head (expected udp with at least one item, or serial)");
  }
  read_lock_to_first(section, clients.lock_to_first,
                     "the first address is silent for `timing.idle_timeout_ms`, which must not be 0");
  lines.serial.lock_to_first = clients.lock_to_first;
}

void check_lock(YamlSection& section, const ping::ClientsConfig& clients) {
  if (clients.lock_to_first && clients.idle_timeout.count() == 0) {
    section.report("lock_to_first", "would last for ever (expected timing.idle_timeout_ms above 0)");
  }
}

void read_identity(YamlSection& section, int least_id, std::string_view revision_meaning,
                   std::string_view minor_meaning, std::uint8_t& id, ping::DeviceInformation& information) {
  section.integer("id", id, least_id, 254,
                  "device ID in the frames of the head, until a client sets another ID");
  section.integer("revision", information.device_revision, 1, 255, revision_meaning);
  section.integer("firmware_major", information.firmware_major, 0, 255,
                  "major version of the firmware that the head reports");
  section.integer("firmware_minor", information.firmware_minor, 0, 255, minor_meaning);
  section.integer("firmware_patch", information.firmware_patch, 0, 255,
                  "patch version of the firmware that the head reports");
}

void read_receivers(YamlSection& section, std::string_view asker_does, ping::ClientsConfig& clients) {
  section.choice("fan_out", clients.fan_out,
                 {{"requester", ping::FanOut::requester}, {"all", ping::FanOut::all}},
                 fmt::format("clients that receive an answer: the client that asked or {}, or `all`, as "
                             "behind a vehicle's bridge",
                             asker_does));
  section.integer("max_clients", clients.max_clients, 2, 1000,
                  "maximum number of clients; then the head drops the longest silent one");
}

void read_time_scale(YamlSection& section, double& time_scale) {
  section.number("scale", time_scale, Range::from(0.0, 100.0),
                 "factor on the time from ping to ping; 0: as fast as pings are rendered");
}

}  // namespace sonard::server
