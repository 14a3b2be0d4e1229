#include "server/recording/gemini_glf.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "protocol/gemini/bearings.hpp"
#include "protocol/glf/log_time.hpp"

namespace sonard::server {
namespace {

constexpr std::uint16_t first_node_id = 100;
constexpr float sector_deg = 120.0F;

// Bits of glf::StatusRecord::link_type (docs/logs.md 1.5).
constexpr std::uint16_t link_vdsl = 0x0001;
constexpr std::uint16_t link_100_mbps = 0x0100;
constexpr std::uint16_t link_negotiated = 0x1000;

glf::Origin origin_of(std::uint16_t device_id, std::int64_t unix_ns, const GlfLogOrigin& origin) {
  return {glf::glf_time_s(unix_ns, origin.utc_offset_s), device_id,
          static_cast<std::uint16_t>(first_node_id + origin.gemini_number)};
}

// Pixels stay in the order of the wire, so this table is in that order too.
std::vector<double> log_bearings_rad(int beams) {
  std::vector<double> bearings = gemini::bearings_rad(beams);
  std::ranges::transform(bearings, bearings.begin(), glf::bearing_for_log);
  return bearings;
}

// Of lines as they are sent, so that a log needs no word on range compression.
std::uint32_t line_frequency_hz(const gemini::PingHead& head) {
  const int native_lines = 1 << head.compression_log2();
  return static_cast<std::uint32_t>(std::lround(gemini::line_rate_hz / native_lines));
}

std::uint16_t ping_flags(const gemini::PingHead& head) {
  // A 720i has one frequency, and it is the low one of the family.
  const bool told = (head.sound_speed_used & gemini::sound_speed_from_config) != 0;
  return told ? glf::ping_flag_bits::manual_sound_speed : std::uint16_t{0};
}

std::uint16_t link_type(std::uint16_t link) {
  if ((link & gemini::link_bits::vdsl) != 0) {
    return link_vdsl | link_negotiated;
  }
  const bool fast = (link & gemini::link_bits::ethernet_100) != 0;
  return static_cast<std::uint16_t>((fast ? link_100_mbps : 0U) | link_negotiated);
}

std::array<std::uint16_t, 3> mac_words(const gemini::MacAddress& mac) {
  std::array<std::uint16_t, 3> words{};
  for (std::size_t i = 0; i < words.size(); ++i) {
    words.at(i) = static_cast<std::uint16_t>(mac.octets.at(2 * i) << 8 | mac.octets.at(2 * i + 1));
  }
  return words;
}

double celsius(std::uint16_t code) {
  return gemini::temperature_celsius(code).value_or(0.0);  // a sensor that is not there
}

}  // namespace

std::vector<std::uint8_t> eight_bit_pixels(const std::vector<std::uint16_t>& samples) {
  std::vector<std::uint8_t> pixels(samples.size());
  std::ranges::transform(samples, pixels.begin(),
                         [](std::uint16_t sample) { return static_cast<std::uint8_t>(sample >> 8); });
  return pixels;
}

glf::ImageRecord to_glf_image(GeminiPing ping, const GlfLogOrigin& origin) {
  const gemini::PingHead& head = ping.head;
  glf::ImageRecord image;
  image.origin = origin_of(head.header.sonar_id, ping.transmit_unix_ns, origin);
  image.transmit_time_s = image.origin.time_s;
  image.lines = static_cast<std::uint32_t>(head.line_count());
  image.beams = head.beams;
  image.pixels = std::move(ping.pixels);
  image.bearings_rad = log_bearings_rad(head.beams);
  image.modulation_frequency_hz = line_frequency_hz(head);
  image.aperture_deg = sector_deg;
  image.ping_flags = ping_flags(head);
  image.sound_speed_mps = static_cast<float>(head.sound_speed_mps());
  image.gain_percent = static_cast<std::int16_t>(std::lround(std::clamp(ping.gain_percent, 0.0, 100.0)));
  return image;
}

glf::StatusRecord to_glf_status(const gemini::Status& status, std::int64_t unix_ns,
                                const GlfLogOrigin& origin) {
  glf::StatusRecord record;
  record.origin = origin_of(status.sonar_id, unix_ns, origin);
  record.bf_firmware_version = status.firmware_version;
  record.device_id = status.sonar_id;
  record.selected_transducer = static_cast<std::uint8_t>(status.transducer);
  record.psu_c = celsius(status.psu2_temperature);
  record.die_c = gemini::die_temperature_celsius(status.die_temperature);
  record.tx_c = celsius(status.tx1_temperature);
  record.afe_c = {celsius(status.vga1a_temperature), celsius(status.vga1b_temperature),
                  celsius(status.vga2a_temperature), celsius(status.vga2b_temperature)};
  record.link_type = link_type(status.link_type);
  record.alternate_ip = status.alternate_ip;
  record.surface_ip = status.surface_ip;
  record.subnet_mask = status.subnet_mask;
  record.mac = mac_words(status.mac);
  record.bf_boot_status = status.boot_status;
  record.fpga_time_us = status.clock_us;
  record.dip_switch = status.dip_switches;
  record.shutdown_status = status.shutdown_status;
  return record;
}

}  // namespace sonard::server
