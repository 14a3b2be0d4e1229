// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping1d/recorded_form.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "protocol/ping1d/codec.hpp"

namespace sonard::ping1d {

Distance measured_by(const Scan& scan, const DeviceConfig& config, std::uint32_t distance_mm,
                     std::uint16_t confidence_percent) {
  return {.distance_mm = distance_mm,
          .confidence_percent = confidence_percent,
          .transmit_duration_us = transmit_duration_us(scan, config),
          .scan_start_mm = scan.start_mm,
          .scan_length_mm = scan.length_mm,
          .gain_setting = scan.gain};
}

PingRecord record_of(const Distance& measured, std::vector<std::uint8_t> profile, double sound_speed_mps,
                     std::uint8_t device_id) {
  PingRecord record;
  const auto points = static_cast<int>(profile.size());
  record.settings = {
      .bins = points,
      .beams = 1,
      .bin_m = 1e-3 * measured.scan_length_mm / std::max(1, points),
      .sound_speed_mps = sound_speed_mps,
      .gain_percent = 100.0 * std::min<std::uint32_t>(measured.gain_setting, most_gain) / most_gain,
      .frequency_hz = carrier_hz};
  record.bearings_rad = {0.0};
  record.samples = std::move(profile);
  record.wire = encode(Profile{measured, {}}, device_id);
  return record;
}

std::optional<Distance> recorded_form(std::span<const std::uint8_t> wire) {
  const auto report = decode_report(wire);
  const auto* const profile = report ? std::get_if<Profile>(&*report) : nullptr;
  return profile != nullptr ? std::optional(profile->measured()) : std::nullopt;
}

PingJob make_job(const ReplayedPing& recorded, const Distance& measured) {
  PingJob job;
  job.native_bins = recorded.settings.bins;
  job.native_bin_m = recorded.settings.bin_m;
  job.sound_speed_mps = recorded.settings.sound_speed_mps;
  job.listening_time = listening_time({.start_mm = std::min(measured.scan_start_mm, most_range_mm),
                                       .length_mm = std::min(measured.scan_length_mm, most_range_mm)});
  job.gain_percent = recorded.settings.gain_percent;
  job.settings = {{"start", fmt::format("{:.2f}m", 1e-3 * measured.scan_start_mm)},
                  {"length", fmt::format("{:.2f}m", 1e-3 * measured.scan_length_mm)},
                  {"gain", fmt::format("{}", measured.gain_setting)}};
  return job;
}

std::vector<Difference> differences(const Scan& asked, const Distance& recorded) {
  std::vector<Difference> found;
  if (asked.start_mm != recorded.scan_start_mm || asked.length_mm != recorded.scan_length_mm) {
    found.push_back({"range", fmt::format("range {} + {} mm requested, {} + {} mm sent", asked.start_mm,
                                          asked.length_mm, recorded.scan_start_mm, recorded.scan_length_mm)});
  }
  if (asked.gain != recorded.gain_setting) {
    found.push_back({"gain", fmt::format("gain {} requested, {} sent", asked.gain, recorded.gain_setting)});
  }
  return found;
}

}  // namespace sonard::ping1d
