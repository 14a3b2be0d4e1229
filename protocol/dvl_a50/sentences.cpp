// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/sentences.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace sonard::dvl_a50 {
namespace {

char letter(bool value) {
  return value ? 'y' : 'n';
}

bool take_number(const std::string& text, double& number) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty()) {
    return true;
  }
  number = value;
  return error == std::errc{} && end == text.data() + text.size();
}

bool take_letter(const std::string& text, bool& value) {
  value = text.empty() ? value : text == "y";
  return text.empty() || text == "y" || text == "n";
}

}  // namespace

std::uint8_t crc8(std::string_view text) {
  unsigned crc = 0;
  for (const char c : text) {
    crc ^= static_cast<std::uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x80U) != 0 ? (crc << 1 ^ 0x07U) & 0xFFU : crc << 1;
    }
  }
  return static_cast<std::uint8_t>(crc);
}

std::string with_checksum(std::string_view text) {
  return fmt::format("{}*{:02x}", text, crc8(text));
}

std::string velocity_sentence(const Velocity& report) {
  std::vector<std::string> covariance;
  for (const Vector& row : report.covariance) {
    for (const double element : row) {
      covariance.push_back(fmt::format("{:g}", element));
    }
  }
  const Vector& v = report.velocity_mps;
  return with_checksum(fmt::format("{},{:.3f},{:.3f},{:.3f},{},{}{:.3f},{},{},{},{:.2f},{}",
                                   report.of_water ? "wrs" : "wrz", v[0], v[1], v[2], letter(report.valid),
                                   report.of_water ? "" : fmt::format("{:.2f},", report.altitude_m),
                                   report.fom_mps, fmt::join(covariance, ";"), report.validity_us,
                                   report.transmission_us, report.since_last_ms, report.status));
}

std::string beam_sentence(const Beam& beam) {
  return with_checksum(fmt::format("wru,{},{:.3f},{:.2f},{:.0f},{:.0f}", beam.id, beam.velocity_mps,
                                   beam.distance_m, beam.rssi_dbm, beam.nsd_dbm));
}

std::string position_sentence(const Position& report) {
  const Vector& p = report.position_m;
  return with_checksum(fmt::format("wrp,{:.3f},{:.2f},{:.2f},{:.2f},{:.1f},{:.1f},{:.1f},{:.1f},{}",
                                   report.time_s, p[0], p[1], p[2], report.std_m, report.roll_deg,
                                   report.pitch_deg, report.yaw_deg, report.status));
}

std::string old_velocity_sentence(const Velocity& report) {
  const Vector& v = report.velocity_mps;
  return with_checksum(fmt::format("wrx,{:.2f},{:.3f},{:.3f},{:.3f},{:.3f},{:.2f},{},{}",
                                   report.since_last_ms, v[0], v[1], v[2], report.fom_mps, report.altitude_m,
                                   letter(report.valid), report.status));
}

std::string old_distance_sentence(const Velocity& report) {
  const auto& beams = report.beams;
  return with_checksum(fmt::format("wrt,{:.2f},{:.2f},{:.2f},{:.2f}", beams[0].distance_m,
                                   beams[1].distance_m, beams[2].distance_m, beams[3].distance_m));
}

std::string settings_text(const Settings& settings) {
  return fmt::format("wrc,{:g},{:g},{},{},{},{}", settings.speed_of_sound_mps,
                     settings.mounting_rotation_offset_deg, letter(settings.acoustic_enabled),
                     letter(settings.dark_mode_enabled), settings.range_mode,
                     letter(settings.periodic_cycling_enabled));
}

std::optional<SerialCommand> parse_command(std::string_view line) {
  SerialCommand command;
  if (const std::size_t star = line.find('*'); star != std::string_view::npos) {
    command.checked = line == with_checksum(line.substr(0, star));
    line = line.substr(0, star);
  }
  if (line.size() < 3 || !line.starts_with("wc")) {
    return std::nullopt;
  }
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    command.options.emplace_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  command.name = command.options.front();
  command.options.erase(command.options.begin());
  return command;
}

bool apply(const std::vector<std::string>& options, Settings& settings) {
  if (options.size() < 4 || options.size() > 6) {
    return false;
  }
  const auto option = [&](std::size_t place) { return place < options.size() ? options[place] : ""; };
  Settings wanted = settings;
  if (!take_number(options[0], wanted.speed_of_sound_mps) ||
      !take_number(options[1], wanted.mounting_rotation_offset_deg) ||
      !take_letter(options[2], wanted.acoustic_enabled) ||
      !take_letter(options[3], wanted.dark_mode_enabled) ||
      !take_letter(option(5), wanted.periodic_cycling_enabled)) {
    return false;
  }
  wanted.range_mode = option(4).empty() ? wanted.range_mode : option(4);
  settings = wanted;
  return true;
}

}  // namespace sonard::dvl_a50
