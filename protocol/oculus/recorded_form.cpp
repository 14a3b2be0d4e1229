// SPDX-License-Identifier: Apache-2.0
#include "protocol/oculus/recorded_form.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "protocol/oculus/codec.hpp"

namespace sonard::oculus {
namespace {

// Smaller differences come from rounding.
constexpr double gain_step_percent = 1.0;
constexpr double sound_speed_step_mps = 0.1;
constexpr double gamma_step = 1e-6;

std::vector<double> bearings_rad(const std::vector<std::int16_t>& bearings_cdeg) {
  std::vector<double> bearings;
  std::ranges::transform(bearings_cdeg, std::back_inserter(bearings),
                         [](std::int16_t cdeg) { return cdeg * std::numbers::pi / 18000.0; });
  return bearings;
}

}  // namespace

PingRecord record_of(const PingResult& ping, std::span<const std::uint8_t> message) {
  PingRecord record;
  record.settings.bins = ping.ranges;
  record.settings.beams = ping.beams;
  record.settings.bin_m = ping.range_resolution_m;
  record.settings.sound_speed_mps = ping.sound_speed_mps;
  record.settings.sound_speed_from_config = ping.fire.fire.sound_speed_mps != 0.0;
  record.settings.frequency_hz = ping.frequency_hz;
  record.settings.amplitude_exponent = gamma_exponent(ping.fire.fire.gamma);
  record.bearings_rad = bearings_rad(ping.bearings_cdeg);
  record.sector_rad = record.bearings_rad.back() - record.bearings_rad.front();
  record.samples = eight_bit_samples(ping);
  const std::size_t fixed = ping.fire.extension ? result_v2_size : result_v1_size;
  const std::span<const std::uint8_t> wire = message.first(fixed + 2 * ping.bearings_cdeg.size());
  record.wire.assign(wire.begin(), wire.end());
  return record;
}

std::optional<PingResult> recorded_form(std::span<const std::uint8_t> wire) {
  auto ping = decode_ping_head(wire);
  if (!ping || ping->ranges < 1 || (ping->beams != 256 && ping->beams != 512)) {
    return std::nullopt;
  }
  return *ping;
}

PingPlan held_to(const ReplayedPing& recorded, const PingPlan& asked) {
  const PingResult sent = recorded_form(recorded.wire).value();
  PingPlan plan = asked;
  PingResult& ping = plan.result;
  const bool many = sent.beams == 512;
  ping.fire.fire.flags = static_cast<std::uint8_t>(many ? ping.fire.fire.flags | fire_flags::beams_512
                                                        : ping.fire.fire.flags & ~fire_flags::beams_512);
  ping.status = sent.status;
  ping.frequency_hz = sent.frequency_hz;
  ping.temperature_c = sent.temperature_c;
  ping.pressure_bar = sent.pressure_bar;
  ping.heading_deg = sent.heading_deg;
  ping.pitch_deg = sent.pitch_deg;
  ping.roll_deg = sent.roll_deg;
  ping.sound_speed_mps = sent.sound_speed_mps;
  ping.range_resolution_m = sent.range_resolution_m;
  ping.ranges = sent.ranges;
  ping.beams = sent.beams;
  ping.bearings_cdeg = sent.bearings_cdeg;
  ping.image_offset = usual_image_offset(ping.fire.extension.has_value(), ping.beams);
  plan.range_m = recorded.settings.range_m();
  const double way_s = 2.0 * plan.range_m / recorded.settings.sound_speed_mps;
  plan.listening = std::chrono::nanoseconds{std::llround(way_s * 1e9)};
  if (recorded.due) {
    plan.period = {};  // its due time sets the rate
  }
  return plan;
}

std::vector<Difference> differences(const PingPlan& asked, const PingPlan& sent,
                                    const RecordedSettings& recorded) {
  const PingResult& want = asked.result;
  std::vector<Difference> found;
  const double row_m = std::max(want.range_resolution_m, recorded.bin_m);
  if (std::abs(asked.range_m - recorded.range_m()) > row_m) {
    found.push_back(
        {"range", fmt::format("range {:.2f} m requested, {:.2f} m sent", asked.range_m, recorded.range_m())});
  }
  if (want.beams != recorded.beams) {
    found.push_back({"beams", fmt::format("{} beams requested, {} sent", want.beams, recorded.beams)});
  }
  if (want.frequency_hz != sent.result.frequency_hz) {
    found.push_back({"frequency", fmt::format("{:.0f} kHz requested, {:.0f} kHz sent",
                                              want.frequency_hz * 1e-3, sent.result.frequency_hz * 1e-3)});
  }
  const double gain_percent = asked.asked.fire.gain_percent;
  if (recorded.gain_percent >= 0.0 && std::abs(gain_percent - recorded.gain_percent) > gain_step_percent) {
    found.push_back(
        {"gain", fmt::format("gain {:.0f} % requested, {:.0f} % sent", gain_percent, recorded.gain_percent)});
  }
  if (std::abs(want.sound_speed_mps - recorded.sound_speed_mps) > sound_speed_step_mps) {
    found.push_back({"sound_speed", fmt::format("sound speed {:.1f} m/s requested, {:.1f} m/s sent",
                                                want.sound_speed_mps, recorded.sound_speed_mps)});
  }
  const double exponent = gamma_exponent(asked.asked.fire.gamma);
  if (std::abs(exponent - recorded.amplitude_exponent) > gamma_step) {
    found.push_back({"gamma", fmt::format("gamma {:.0f} requested, {:.0f} sent", 255.0 * exponent,
                                          255.0 * recorded.amplitude_exponent)});
  }
  if (want.data_size != DataSize::bits_8) {
    found.push_back({"bits", fmt::format("{} bits requested, 8 sent in their place",
                                         8 * bytes_per_sample(want.data_size))});
  }
  return found;
}

}  // namespace sonard::oculus
