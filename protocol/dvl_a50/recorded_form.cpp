// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/recorded_form.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "protocol/dvl_a50/codec.hpp"

namespace sonard::dvl_a50 {
namespace {

constexpr int bins = 200;
constexpr std::uint8_t mark = 255;

}  // namespace

PingRecord record_of(const Velocity& report, double range_m, double sound_speed_mps) {
  PingRecord record;
  record.settings = {.bins = bins, .beams = 1, .bin_m = range_m / bins, .sound_speed_mps = sound_speed_mps};
  record.bearings_rad = {0.0};
  record.samples.resize(bins);
  for (const Beam& beam : report.beams) {
    const double bin = beam.distance_m / record.settings.bin_m;
    if (bin >= 0.0 && bin < bins) {
      record.samples[static_cast<std::size_t>(bin)] = mark;
    }
  }
  const std::string text = encode(report, texts_of(Release::v2_7_2).format);
  record.wire.assign(text.begin(), text.end());
  return record;
}

std::optional<Velocity> recorded_form(std::span<const std::uint8_t> wire) {
  const std::string text(wire.begin(), wire.end());
  const std::optional<Json> message = parse_json(text);
  return message ? decode_velocity(*message) : std::nullopt;
}

PingJob make_job(const ReplayedPing& recorded) {
  PingJob job;
  job.native_bins = recorded.settings.bins;
  job.native_bin_m = recorded.settings.bin_m;
  job.sound_speed_mps = recorded.settings.sound_speed_mps;
  const double listening_s = 2.0 * job.range_m() / std::max(1.0, job.sound_speed_mps);
  job.listening_time = std::chrono::nanoseconds{std::llround(1e9 * std::clamp(listening_s, 0.0, 10.0))};
  job.settings = {{"range", fmt::format("{:.2f}m", job.range_m())}};
  return job;
}

}  // namespace sonard::dvl_a50
