// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/recorded_form.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include <fmt/format.h>

#include "protocol/gemini/bearings.hpp"
#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/rle.hpp"

namespace sonard::gemini {
namespace {

constexpr double sector_rad = 2.0 * std::numbers::pi / 3.0;
constexpr int most_native_lines = 0xFFFF;
constexpr int most_compression_log2 = 4;
constexpr double step_tolerance = 1e-3;  // logs round the line rate to whole hertz, the speed to 0.1 m/s

// Smaller differences come from rounding.
constexpr double gain_step_percent = 1.0;      // logs keep whole percents
constexpr double sound_speed_step_mps = 0.11;  // the wire has steps of 0.1 m/s
constexpr double range_slack = 0.002;          // relative; a .glf rounds the line rate

std::vector<std::uint8_t> decoded_samples(const PingHead& head, const PingImage& image) {
  std::vector<std::uint8_t> samples;
  if (!head.eight_bit()) {
    samples.reserve(image.u16.size());
    std::ranges::transform(image.u16, std::back_inserter(samples),
                           [](std::uint16_t sample) { return static_cast<std::uint8_t>(sample >> 8); });
    return samples;
  }
  samples = image.u8;
  if (head.rle_threshold > 0) {
    const std::uint8_t least = least_literal(head.rle_threshold);
    std::ranges::replace_if(
        samples, [least](std::uint8_t sample) { return sample < least; }, std::uint8_t{0});
  }
  return samples;
}

}  // namespace

RecordedSettings settings_of(const PingHead& head) {
  RecordedSettings settings;
  settings.bins = head.line_count();
  settings.beams = head.beams;
  settings.bin_m = head.sound_speed_mps() / (2.0 * line_rate_hz) * (1 << head.compression_log2());
  settings.sound_speed_mps = head.sound_speed_mps();
  settings.sound_speed_from_config = (head.sound_speed_used & gemini::sound_speed_from_config) != 0;
  settings.frequency_hz = carrier_hz;
  return settings;
}

PingRecord record_of(const PingHead& head, const PingImage& image) {
  PingRecord record;
  record.settings = settings_of(head);
  record.range_compression_log2 = head.compression_log2();
  record.bearings_rad = bearings_rad(head.beams);
  record.sector_rad = sector_rad;
  record.samples = decoded_samples(head, image);
  record.wire = encode(Report{head});
  return record;
}

std::optional<RecordedForm> recorded_form(const RecordedSettings& settings) {
  const double native_step_m = settings.sound_speed_mps / (2.0 * line_rate_hz);
  const double lines_per_line = settings.bin_m / native_step_m;
  const int compression_log2 =
      std::clamp(static_cast<int>(std::lround(std::log2(lines_per_line))), 0, most_compression_log2);
  if (settings.beams != beam_count || settings.bins < 1 ||
      settings.bins > most_native_lines >> compression_log2) {
    return std::nullopt;
  }
  return RecordedForm{settings.bins, compression_log2,
                      std::abs(lines_per_line / (1 << compression_log2) - 1.0) < step_tolerance};
}

PingPlan held_to(const ReplayedPing& recorded, const PingPlan& asked, const DeviceConfig& device) {
  const RecordedSettings& settings = recorded.settings;
  const RecordedForm form = recorded_form(settings).value();
  PingPlan plan = asked;
  if (recorded.due) {
    plan.interval = {};
  }
  plan.job.native_bins = form.lines << form.compression_log2;
  plan.job.compression_log2 = form.compression_log2;
  plan.job.sound_speed_mps = settings.sound_speed_mps;
  plan.job.assumed_sound_speed_mps = settings.sound_speed_mps;
  plan.job.native_bin_m = settings.sound_speed_mps / (2.0 * line_rate_hz);
  plan.job.listening_time = acoustic_time(plan.job.native_bins);
  plan.job.sixteen_bit = false;
  plan.rle_threshold = 0;

  plan.head.ext_mode = static_cast<std::uint16_t>(asked.head.ext_mode | ext_bits::eight_bit);
  plan.head.end_range = static_cast<std::uint16_t>(plan.job.native_bins);
  plan.head.velocimeter_speed = speed_code(settings.sound_speed_mps, device.snap_sound_speed);
  plan.head.sound_speed_used = static_cast<std::uint16_t>(
      (settings.sound_speed_from_config ? sound_speed_from_config : 0U) | plan.head.velocimeter_speed);
  plan.head.rle_threshold = 0;
  plan.head.range_compression = static_cast<std::uint8_t>(form.compression_log2);
  return plan;
}

std::vector<Difference> differences(const PingPlan& asked, const PingPlan& sent,
                                    const RecordedSettings& recorded) {
  const PingJob& job = asked.job;
  std::vector<Difference> found;
  // Tolerance: one line for the remainder of the compression, and range_slack for the rounded line rate.
  if (std::abs(job.range_m() - recorded.range_m()) > recorded.bin_m + range_slack * recorded.range_m()) {
    found.push_back(
        {"range", fmt::format("range {:.2f} m requested, {:.2f} m sent", job.range_m(), recorded.range_m())});
  }
  if (job.compression_log2 != sent.job.compression_log2) {
    found.push_back({"compression", fmt::format("compression x{} requested, x{} sent",
                                                1 << job.compression_log2, 1 << sent.job.compression_log2)});
  }
  if (recorded.gain_percent >= 0.0 &&
      std::abs(job.gain_percent - recorded.gain_percent) > gain_step_percent) {
    found.push_back({"gain", fmt::format("gain {:.0f} % requested, {:.0f} % sent", job.gain_percent,
                                         recorded.gain_percent)});
  }
  if (std::abs(job.assumed_sound_speed_mps - recorded.sound_speed_mps) > sound_speed_step_mps) {
    found.push_back({"sound_speed", fmt::format("sound speed {:.1f} m/s requested, {:.1f} m/s sent",
                                                job.assumed_sound_speed_mps, recorded.sound_speed_mps)});
  }
  if (job.sixteen_bit) {
    found.push_back({"16_bit", "16 bits requested, 8 bits sent"});
  }
  if (asked.rle_threshold > 0) {
    found.push_back({"run_lengths", "run lengths requested, all samples sent"});
  }
  if (!job.transmit) {
    found.push_back({"listening_only", "listening only requested, a ping with its echoes sent"});
  }
  return found;
}

}  // namespace sonard::gemini
