// SPDX-License-Identifier: Apache-2.0
#include "server/logs/capture_summary.hpp"

#include <optional>

#include <fmt/format.h>

#include "protocol/common/byte_reader.hpp"
#include "protocol/pcapng/blocks.hpp"
#include "server/logs/damage_text.hpp"

namespace sonard::server {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint8_t udp = 17;
constexpr std::uint8_t tcp = 6;
constexpr std::size_t udp_header_size = 8;

struct Payload {
  std::uint8_t transport = 0;
  Bytes bytes;  ///< only for UDP
};

// Reads IPv4 of link type RAW; for other packets the payload is empty.
Payload payload_of(Bytes packet) {
  ByteReader reader(packet);
  const std::uint8_t version = reader.u8("version");
  reader.skip(8, "header");
  Payload payload{reader.u8("protocol"), {}};
  const std::size_t header_size = (version & 0xFU) * 4U;
  if (!reader.ok() || version >> 4 != 4) {
    return {};
  }
  if (payload.transport == udp && packet.size() >= header_size + udp_header_size) {
    payload.bytes = packet.subspan(header_size + udp_header_size);
  }
  return payload;
}

void add_packet(LogSummary& log, const pcapng::Packet& packet, const PingFinder& ping_in) {
  const auto time_ns = static_cast<std::int64_t>(packet.time_ns);
  include(log, time_ns);
  const Payload payload = payload_of(packet.bytes);
  count(log, payload.transport == udp   ? "UDP packets"
             : payload.transport == tcp ? "TCP packets"
                                        : "other packets");
  const std::optional<CapturedPing> ping = ping_in(payload.bytes);
  if (ping && plausible_time(time_ns)) {
    add_ping(head_of(log, {}, ping->type, ping->device_id, ping->settings.beams == 1), time_ns,
             ping->settings);
  }
}

// Errors of packets whose blocks are readable.
struct PacketFaults {
  std::uint64_t times = 0;
  std::uint64_t checksums = 0;
  std::uint64_t interfaces = 0;
};

void add_faults(LogSummary& log, const PacketFaults& faults) {
  if (faults.times > 0) {
    log.problems.push_back(fmt::format("{} packet{} impossible times; their pings are left out", faults.times,
                                       faults.times == 1 ? " has" : "s have"));
  }
  if (faults.interfaces > 0) {
    log.problems.push_back(
        fmt::format("damaged: {} packet{} an interface that the capture does not describe; "
                    "their pings are counted",
                    faults.interfaces, faults.interfaces == 1 ? " names" : "s name"));
  }
  if (faults.checksums > 0) {
    log.problems.push_back(
        fmt::format("{} packet{} wrong checksums: damaged, or captured before the network card "
                    "filled them in",
                    faults.checksums, faults.checksums == 1 ? " has" : "s have"));
  }
}

}  // namespace

void summarise_capture(LogSummary& log, const LogFile& file, const PingFinder& ping_in) {
  std::uint64_t interfaces = 0;
  std::uint64_t of_section = 0;  // interfaces of this section; packets refer to them by number
  std::uint64_t others = 0;
  PacketFaults faults;
  std::optional<pcapng::Block> first;
  const auto damaged = pcapng::for_each_block(file.bytes(), [&](const pcapng::Block& block) {
    first = first.value_or(block);
    switch (static_cast<pcapng::BlockType>(block.type)) {
      case pcapng::BlockType::section_header:
        of_section = 0;
        return;
      case pcapng::BlockType::interface_description:
        ++interfaces;
        ++of_section;
        return;
      case pcapng::BlockType::enhanced_packet:
        if (const auto packet = pcapng::read_packet(block)) {
          faults.times += plausible_time(static_cast<std::int64_t>(packet->time_ns)) ? 0 : 1;
          faults.checksums += pcapng::has_right_checksums(packet->bytes) ? 0 : 1;
          faults.interfaces += packet->interface < of_section ? 0 : 1;
          add_packet(log, *packet, ping_in);
        }
        return;
    }
    ++others;
  });
  if (!damaged) {
    throw file.error(fmt::format("is not a .pcapng log, or none of its blocks can be read ({})",
                                 to_string(damaged.error())));
  }
  log.other_records.insert(log.other_records.begin(), {"interfaces", interfaces});
  if (others > 0) {
    count(log, "blocks of other types", others);
  }
  // Sections and interfaces are described before the packets.
  const bool lost_no_packet =
      first && first->type != static_cast<std::uint32_t>(pcapng::BlockType::enhanced_packet);
  add_damage(log.problems, *damaged, [&](const Damage& part) {
    return std::string(part.offset == 0 && lost_no_packet ? "no packet is lost"
                                                          : "the packets in them are lost");
  });
  add_faults(log, faults);
}

}  // namespace sonard::server
