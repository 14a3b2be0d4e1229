// SPDX-License-Identifier: Apache-2.0
#include "protocol/micron/line_timing.hpp"

#include <algorithm>

#include "protocol/micron/units.hpp"

namespace sonard::micron {
namespace {

constexpr int line_frame_size = 45;  // without the data
constexpr int bits_per_byte = 10;    // start bit, eight bits, stop bit

}  // namespace

int effective_bins(const HeadCommand& command) {
  return std::clamp<int>(command.bins, 1, max_bins);
}

int effective_ad_interval(const HeadCommand& command) {
  return std::max<int>(command.ad_interval, 1);
}

std::chrono::nanoseconds turning_time(const HeadCommand& command, int units) {
  return units * command.motor_time * motor_time_unit;
}

LineTiming line_timing(const HeadCommand& command, const DeviceConfig& config, int units) {
  const int bins = effective_bins(command);
  const int data = command.has(control_bits::eight_bit) ? bins : (bins + 1) / 2;
  return {.listen = bins * effective_ad_interval(command) * ad_interval_unit,
          .turn = turning_time(command, units),
          .send = std::chrono::nanoseconds{std::chrono::seconds{(line_frame_size + data) * bits_per_byte}} /
                  config.baud};
}

std::chrono::nanoseconds LineTiming::period(const DeviceConfig& config) const {
  if (config.half_duplex) {
    return listen + turn + send + config.line_overhead;
  }
  return std::max(listen + turn, send) + config.line_overhead;
}

}  // namespace sonard::micron
