// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/messages.hpp"

#include <algorithm>
#include <cmath>

namespace sonard::gemini {

int compression_log2(std::uint16_t range_compression) {
  const int bits = range_compression & 7;
  return bits <= 4 ? bits : 0;
}

bool PingConfig::eight_bit() const {
  return (ext_mode & ext_bits::eight_bit) != 0 && data_type() == DataType::beam_magnitude;
}

std::uint8_t PingConfig::rle_threshold_applied() const {
  if (rle_threshold == 0 || !eight_bit()) {
    return 0;
  }
  return static_cast<std::uint8_t>(std::clamp<std::uint16_t>(rle_threshold, 3, 255));
}

int PingHead::line_count() const {
  return std::max(0, int{end_range} - int{start_range}) >> compression_log2();
}

bool PingLine::operator==(const PingLine& other) const {
  return header == other.header && gain == other.gain && ping_id == other.ping_id &&
         line_id == other.line_id && scale == other.scale && line_info == other.line_info &&
         std::ranges::equal(data, other.data);
}

std::uint16_t temperature_code(double celsius) {
  const double clamped = std::clamp(celsius, -128.0, 127.75);
  const auto quarters = static_cast<std::int32_t>(std::lround(clamped * 4.0));
  return static_cast<std::uint16_t>(0x8000U | (static_cast<std::uint32_t>(quarters) & 0x3FFU));
}

std::optional<double> temperature_celsius(std::uint16_t code) {
  if ((code & 0x8000) == 0) {
    return std::nullopt;
  }
  const int magnitude = code & 0x3FF;
  return (magnitude < 0x200 ? magnitude : magnitude - 0x400) * 0.25;
}

std::uint16_t die_temperature_code(double celsius) {
  const double code = std::round((celsius + 273.15) * 1024.0 / 503.975);
  return static_cast<std::uint16_t>(std::clamp(code, 0.0, 1023.0));
}

double die_temperature_celsius(std::uint16_t code) {
  return code * 503.975 / 1024.0 - 273.15;
}

}  // namespace sonard::gemini
