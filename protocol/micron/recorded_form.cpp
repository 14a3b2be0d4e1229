// SPDX-License-Identifier: Apache-2.0
#include "protocol/micron/recorded_form.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>

#include <fmt/format.h>

#include "protocol/micron/codec.hpp"
#include "protocol/micron/line_timing.hpp"
#include "protocol/micron/scan_settings.hpp"
#include "protocol/micron/units.hpp"

namespace sonard::micron {
namespace {

std::string bits_text(bool eight_bit) {
  return eight_bit ? "8 bits" : "4 bits";
}

std::string sector_text(std::uint16_t control, int left, int right) {
  return (control & control_bits::continuous) != 0
             ? "all round"
             : fmt::format("{:.1f} to {:.1f} degrees", bearing_deg(left), bearing_deg(right));
}

}  // namespace

std::vector<std::uint8_t> recorded_wire(const HeadData& line, std::uint8_t node) {
  HeadData kept = line;
  kept.data = {};
  return encode(Report{kept}, node);
}

std::optional<HeadData> recorded_line(std::span<const std::uint8_t> wire) {
  const auto report = decode_report(wire);
  const auto* const said = report ? std::get_if<HeadData>(&*report) : nullptr;
  if (said == nullptr) {
    return std::nullopt;
  }
  HeadData kept = *said;
  kept.data = {};
  return kept;
}

std::vector<Difference> differences(const HeadCommand& asked, const PingJob& sent, const HeadData& recorded) {
  std::vector<Difference> found;
  const int bins = effective_bins(asked);
  const double bin_m = bin_time_s(effective_ad_interval(asked)) * sent.sound_speed_mps / 2.0;
  if (std::abs(bins * bin_m - sent.range_m()) > std::max(bin_m, sent.bin_m())) {
    found.push_back(
        {"range", fmt::format("range {:.2f} m requested, {:.2f} m sent", bins * bin_m, sent.range_m())});
  }
  if (bins != sent.bins()) {
    found.push_back({"bins", fmt::format("{} bins requested, {} sent", bins, sent.bins())});
  }
  if (asked.gain[0] != recorded.gain) {
    found.push_back({"gain", fmt::format("gain {:.1f} dB requested, {:.1f} dB sent", gain_db(asked.gain[0]),
                                         sent.gain_db)});
  }
  const bool eight_bit = asked.has(control_bits::eight_bit);
  if (eight_bit != recorded.eight_bit()) {
    found.push_back({"bits", fmt::format("{} requested, {} sent", bits_text(eight_bit),
                                         bits_text(recorded.eight_bit()))});
  }
  const std::string asked_sector = sector_text(asked.control, asked.left_limit, asked.right_limit);
  const std::string sector = sector_text(recorded.control, recorded.left_limit, recorded.right_limit);
  if (asked_sector != sector) {
    found.push_back({"sector", fmt::format("sector {} requested, {} sent", asked_sector, sector)});
  }
  if (asked.step != recorded.step) {
    found.push_back(
        {"step", fmt::format("step {} requested, {} sent (1/16 gradian)", asked.step, recorded.step)});
  }
  if (asked.has(control_bits::transmit_off) && sent.transmit) {
    found.push_back({"listening_only", "listening only requested, a line with its echoes sent"});
  }
  return found;
}

}  // namespace sonard::micron
