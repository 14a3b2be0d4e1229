#include "server/logs/capture_summary.hpp"

#include <variant>

#include <fmt/format.h>

#include "protocol/common/byte_reader.hpp"
#include "protocol/gemini/codec.hpp"
#include "protocol/pcapng/blocks.hpp"

namespace sonard::server {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint8_t udp = 17;
constexpr std::uint8_t tcp = 6;
constexpr std::size_t udp_header_size = 8;
constexpr std::uint16_t resent_head_bit = 0x0100;  // of PingHead::ping_id

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

RecordedSettings settings_of(const gemini::PingHead& head) {
  RecordedSettings settings;
  settings.lines = head.line_count();
  settings.beams = head.beams;
  settings.sound_speed_mps = head.sound_speed_mps();
  settings.line_step_m =
      head.sound_speed_mps() / (2.0 * gemini::line_rate_hz) * (1 << head.compression_log2());
  settings.sound_speed_from_config = (head.sound_speed_used & gemini::sound_speed_from_config) != 0;
  return settings;
}

void add_packet(LogSummary& log, const pcapng::Packet& packet) {
  const auto time_ns = static_cast<std::int64_t>(packet.time_ns);
  include(log, time_ns);
  const Payload payload = payload_of(packet.bytes);
  count(log, payload.transport == udp   ? "UDP packets"
             : payload.transport == tcp ? "TCP packets"
                                        : "other packets");
  const auto report = gemini::decode_report(payload.bytes);
  const auto* const head = report ? std::get_if<gemini::PingHead>(&*report) : nullptr;
  if (head != nullptr && plausible_time(time_ns) && (head->ping_id & resent_head_bit) == 0) {
    add_ping(head_of(log, {}, head->header.sonar_id, false), time_ns, settings_of(*head));
  }
}

}  // namespace

void summarise_capture(LogSummary& log, const LogFile& file) {
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
        add_packet(log, *packet);
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
