#include "server/replay/differences.hpp"

#include <cmath>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace sonard::server {
namespace {

constexpr double gain_step_percent = 1.0;      // logs keep whole percents
constexpr double sound_speed_step_mps = 0.11;  // the wire keeps tenths
// A line for the remainder that compression leaves, and a hair for the rate of lines that a .glf rounds.
constexpr double range_slack = 0.002;

std::optional<std::string> if_apart(bool apart, const std::string& text) {
  return apart ? std::optional(text) : std::nullopt;
}

}  // namespace

std::string_view name_of(Difference kind) {
  constexpr std::array<std::string_view, difference_count> names{
      "range", "compression", "gain", "sound_speed", "16_bit", "run_lengths", "listening_only"};
  return names.at(static_cast<std::size_t>(kind));
}

std::optional<std::string> difference(Difference kind, const gemini::PingJob& asked,
                                      const gemini::RecordedPing& sent, const RecordedSettings& recorded) {
  switch (kind) {
    case Difference::range: {
      const double range_m = asked.native_lines * asked.line_step_m;
      const double slack_m = recorded.line_step_m + range_slack * recorded.range_m();
      return if_apart(std::abs(range_m - recorded.range_m()) > slack_m,
                      fmt::format("range {:.2f} m asked for, {:.2f} m sent", range_m, recorded.range_m()));
    }
    case Difference::compression:
      return if_apart(asked.compression_log2 != sent.compression_log2,
                      fmt::format("compression x{} asked for, x{} sent", 1 << asked.compression_log2,
                                  1 << sent.compression_log2));
    case Difference::gain:
      return if_apart(
          recorded.gain_percent >= 0.0 &&
              std::abs(asked.gain_percent - recorded.gain_percent) > gain_step_percent,
          fmt::format("gain {:.0f} % asked for, {:.0f} % sent", asked.gain_percent, recorded.gain_percent));
    case Difference::sound_speed:
      return if_apart(
          std::abs(asked.assumed_sound_speed_mps - recorded.sound_speed_mps) > sound_speed_step_mps,
          fmt::format("sound speed {:.1f} m/s asked for, {:.1f} m/s sent", asked.assumed_sound_speed_mps,
                      recorded.sound_speed_mps));
    case Difference::sixteen_bit:
      return if_apart(asked.sixteen_bit, "16 bits asked for, 8 bits sent");
    case Difference::run_lengths:
      return if_apart(asked.rle_threshold > 0, "run lengths asked for, all samples sent");
    case Difference::listening_only:
      break;
  }
  return if_apart(!asked.transmit, "listening only asked for, a ping with its echoes sent");
}

void DifferenceLog::add(const gemini::PingJob& asked, const gemini::RecordedPing& sent,
                        const RecordedSettings& recorded) {
  for (std::size_t i = 0; i < difference_count; ++i) {
    const auto text = difference(static_cast<Difference>(i), asked, sent, recorded);
    if (text && pings_.at(i)++ == 0) {
      spdlog::warn("head={} differs from the recording: {}", head_, *text);
    }
  }
}

void DifferenceLog::log_totals() const {
  std::string text;
  for (std::size_t i = 0; i < difference_count; ++i) {
    if (pings_.at(i) > 0) {
      text += fmt::format(" {}={}", name_of(static_cast<Difference>(i)), pings_.at(i));
    }
  }
  if (!text.empty()) {
    spdlog::info("head={} pings that differed from what was asked for:{}", head_, text);
  }
}

}  // namespace sonard::server
