#include "server/replay/differences.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "protocol/micron/line_timing.hpp"
#include "protocol/micron/scan_settings.hpp"
#include "protocol/micron/units.hpp"

namespace sonard::server {
namespace {

constexpr double gain_step_percent = 1.0;      // logs keep whole percents
constexpr double sound_speed_step_mps = 0.11;  // the wire keeps tenths
// A line for the remainder that compression leaves, and a hair for the rate of lines that a .glf rounds.
constexpr double range_slack = 0.002;

std::string bits_text(bool eight_bit) {
  return eight_bit ? "8 bits" : "4 bits";
}

std::string sector_text(std::uint16_t control, int left, int right) {
  return (control & micron::control_bits::continuous) != 0
             ? "all round"
             : fmt::format("{:.1f} to {:.1f} degrees", micron::bearing_deg(left), micron::bearing_deg(right));
}

}  // namespace

std::vector<Difference> differences(const gemini::PingJob& asked, const gemini::RecordedPing& sent,
                                    const RecordedSettings& recorded) {
  std::vector<Difference> found;
  const double range_m = asked.native_lines * asked.line_step_m;
  if (std::abs(range_m - recorded.range_m()) > recorded.line_step_m + range_slack * recorded.range_m()) {
    found.push_back(
        {"range", fmt::format("range {:.2f} m asked for, {:.2f} m sent", range_m, recorded.range_m())});
  }
  if (asked.compression_log2 != sent.compression_log2) {
    found.push_back({"compression", fmt::format("compression x{} asked for, x{} sent",
                                                1 << asked.compression_log2, 1 << sent.compression_log2)});
  }
  if (recorded.gain_percent >= 0.0 &&
      std::abs(asked.gain_percent - recorded.gain_percent) > gain_step_percent) {
    found.push_back({"gain", fmt::format("gain {:.0f} % asked for, {:.0f} % sent", asked.gain_percent,
                                         recorded.gain_percent)});
  }
  if (std::abs(asked.assumed_sound_speed_mps - recorded.sound_speed_mps) > sound_speed_step_mps) {
    found.push_back({"sound_speed", fmt::format("sound speed {:.1f} m/s asked for, {:.1f} m/s sent",
                                                asked.assumed_sound_speed_mps, recorded.sound_speed_mps)});
  }
  if (asked.sixteen_bit) {
    found.push_back({"16_bit", "16 bits asked for, 8 bits sent"});
  }
  if (asked.rle_threshold > 0) {
    found.push_back({"run_lengths", "run lengths asked for, all samples sent"});
  }
  if (!asked.transmit) {
    found.push_back({"listening_only", "listening only asked for, a ping with its echoes sent"});
  }
  return found;
}

std::vector<Difference> differences(const micron::HeadCommand& asked, const micron::MicronJob& sent,
                                    const micron::HeadData& recorded) {
  using namespace micron::control_bits;
  std::vector<Difference> found;
  const int bins = micron::effective_bins(asked);
  const double bin_m = micron::bin_time_s(micron::effective_ad_interval(asked)) * sent.sound_speed_mps / 2.0;
  if (std::abs(bins * bin_m - sent.range_m()) > std::max(bin_m, sent.bin_length_m)) {
    found.push_back(
        {"range", fmt::format("range {:.2f} m asked for, {:.2f} m sent", bins * bin_m, sent.range_m())});
  }
  if (bins != sent.bins) {
    found.push_back({"bins", fmt::format("{} bins asked for, {} sent", bins, sent.bins)});
  }
  if (asked.gain[0] != recorded.gain) {
    found.push_back({"gain", fmt::format("gain {:.1f} dB asked for, {:.1f} dB sent",
                                         micron::gain_db(asked.gain[0]), sent.gain_db)});
  }
  if (asked.has(eight_bit) != recorded.eight_bit()) {
    found.push_back({"bits", fmt::format("{} asked for, {} sent", bits_text(asked.has(eight_bit)),
                                         bits_text(recorded.eight_bit()))});
  }
  const std::string asked_sector = sector_text(asked.control, asked.left_limit, asked.right_limit);
  const std::string sector = sector_text(recorded.control, recorded.left_limit, recorded.right_limit);
  if (asked_sector != sector) {
    found.push_back({"sector", fmt::format("sector {} asked for, {} sent", asked_sector, sector)});
  }
  if (asked.step != recorded.step) {
    found.push_back(
        {"step", fmt::format("step {} asked for, {} sent (1/16 gradian)", asked.step, recorded.step)});
  }
  if (asked.has(transmit_off) && sent.transmit) {
    found.push_back({"listening_only", "listening only asked for, a line with its echoes sent"});
  }
  return found;
}

void DifferenceLog::add(const std::vector<Difference>& found) {
  for (const Difference& difference : found) {
    const auto known =
        std::ranges::find(pings_, difference.kind, &std::pair<std::string_view, std::uint64_t>::first);
    if (known != pings_.end()) {
      ++known->second;
    } else {
      pings_.emplace_back(difference.kind, 1);
      spdlog::warn("head={} differs from the recording: {}", head_, difference.text);
    }
  }
}

void DifferenceLog::log_totals() const {
  std::string text;
  for (const auto& [kind, pings] : pings_) {
    text += fmt::format(" {}={}", kind, pings);
  }
  if (!text.empty()) {
    spdlog::info("head={} pings that differed from what was asked for:{}", head_, text);
  }
}

}  // namespace sonard::server
