// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping360/settings_text.hpp"

#include <fmt/format.h>

#include "protocol/ping360/units.hpp"

namespace sonard::ping360 {

std::vector<Setting> settings_of(const PingJob& job, const PingForm& form) {
  constexpr std::string_view gains[] = {"low", "normal", "high"};
  const DeviceData& settings = form.settings;
  std::vector<Setting> said{
      {"range", fmt::format("{:.2f}m", job.range_m())},
      {"samples", fmt::format("{}", job.bins())},
      {"sample", fmt::format("{:.1f}mm", 1e3 * job.bin_m())},
      {"sample_period", fmt::format("{:.2f}us", 1e6 * sample_time_s(settings.sample_period))},
      {"pulse", fmt::format("{}us", settings.transmit_duration_us)},
      {"frequency", fmt::format("{}kHz", settings.transmit_frequency_khz)},
      {"gain", settings.gain_setting < std::size(gains) ? std::string(gains[settings.gain_setting])
                                                        : fmt::format("{}", settings.gain_setting)}};
  if (form.scan) {
    said.push_back({"scan", form.scan->start_angle == form.scan->stop_angle ? "stares" : "auto"});
    said.push_back({"from", fmt::format("{}grad", form.scan->start_angle)});
    said.push_back({"to", fmt::format("{}grad", form.scan->stop_angle)});
    said.push_back({"step", fmt::format("{}grad", form.scan->num_steps)});
    said.push_back({"delay", fmt::format("{}ms", form.scan->delay_ms)});
  }
  return said;
}

std::string scan_text(const AutoTransmit& scan) {
  return fmt::format("{} to {} gradians, step {}", scan.start_angle, scan.stop_angle, scan.num_steps);
}

}  // namespace sonard::ping360
