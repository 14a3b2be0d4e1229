// SPDX-License-Identifier: Apache-2.0
#include "server/logs/capture_summary.hpp"

#include <optional>

#include <fmt/format.h>

#include "protocol/common/byte_reader.hpp"
#include "protocol/pcapng/blocks.hpp"

namespace sonard::server {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint8_t udp = 17;
constexpr std::uint8_t tcp = 6;
constexpr std::size_t udp_header_size = 8;

struct Payload {
  std::uint8_t transport = 0;
  Bytes bytes;  ///< of UDP only
};

// IPv4 as link type RAW has it; anything else is no payload.
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
  const std::optional<PingSeen> ping = ping_in(payload.bytes);
  if (ping && plausible_time(time_ns)) {
    add_ping(head_of(log, {}, ping->device, ping->device_id, ping->settings.beams == 1), time_ns,
             ping->settings);
  }
}

}  // namespace

void summarise_capture(LogSummary& log, const LogFile& file, const PingFinder& ping_in) {
  const auto whole = pcapng::recover(file.bytes());
  if (!whole) {
    throw file.error(to_string(whole.error()));
  }
  count(log, "interfaces", whole->interfaces);
  for (std::size_t offset = 0; offset < whole->keep_size;) {
    const auto block = pcapng::block_at(file.bytes(), offset);
    if (!block || !*block) {
      break;  // recover() has been here
    }
    if ((*block)->type == static_cast<std::uint32_t>(pcapng::BlockType::enhanced_packet)) {
      if (const auto packet = pcapng::read_packet(**block)) {
        add_packet(log, *packet, ping_in);
      }
    }
    offset = (*block)->end();
  }
  if (const std::size_t tail = file.bytes().size() - whole->keep_size; tail > 0) {
    log.problems.push_back(
        fmt::format("cut or damaged: {} bytes after the last whole block cannot be read", tail));
  }
}

}  // namespace sonard::server
