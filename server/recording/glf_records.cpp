// SPDX-License-Identifier: Apache-2.0
#include "server/recording/glf_records.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>
#include <vector>

#include "protocol/glf/log_time.hpp"

namespace sonard::server {
namespace {

constexpr std::uint16_t first_node_id = 100;

// Pixels stay in wire order, so this table is in wire order too.
std::vector<double> log_bearings_rad(const std::vector<double>& bearings_rad) {
  std::vector<double> bearings;
  std::ranges::transform(bearings_rad, std::back_inserter(bearings), glf::bearing_for_log);
  return bearings;
}

// Frequency of lines as sent; the field of range compression does not change the range. The small addend
// makes a half round up, whatever the rounding error of the division.
std::uint32_t line_frequency_hz(const RecordedSettings& settings) {
  constexpr double of_the_division = 1e-6;
  return static_cast<std::uint32_t>(
      std::lround(settings.sound_speed_mps / (2.0 * settings.bin_m) + of_the_division));
}

}  // namespace

glf::Origin glf_origin(std::int64_t unix_ns, const GlfLogOrigin& origin) {
  return {glf::glf_time_s(unix_ns, origin.utc_offset_s), origin.device_id,
          static_cast<std::uint16_t>(first_node_id + origin.number)};
}

glf::ImageRecord glf_image(PingRecord ping, std::int64_t transmit_unix_ns, const GlfLogOrigin& origin) {
  const RecordedSettings& settings = ping.settings;
  glf::ImageRecord image;
  image.origin = glf_origin(transmit_unix_ns, origin);
  image.transmit_time_s = image.origin.time_s;
  image.lines = static_cast<std::uint32_t>(settings.bins);
  image.beams = static_cast<std::uint32_t>(settings.beams);
  image.range_compression = static_cast<std::uint16_t>(ping.range_compression_log2);
  image.pixels = std::move(ping.samples);
  image.bearings_rad = log_bearings_rad(ping.bearings_rad);
  image.modulation_frequency_hz = line_frequency_hz(settings);
  image.aperture_deg = static_cast<float>(ping.sector_rad * 180.0 / std::numbers::pi);
  // A head with one frequency is recorded as using the low one of its family.
  image.ping_flags =
      settings.sound_speed_from_config ? glf::ping_flag_bits::manual_sound_speed : std::uint16_t{0};
  image.sound_speed_mps = static_cast<float>(settings.sound_speed_mps);
  image.gain_percent = static_cast<std::int16_t>(std::lround(std::clamp(settings.gain_percent, 0.0, 100.0)));
  return image;
}

}  // namespace sonard::server
