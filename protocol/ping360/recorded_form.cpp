// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping360/recorded_form.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "protocol/ping360/codec.hpp"
#include "protocol/ping360/settings_text.hpp"
#include "protocol/ping360/units.hpp"

namespace sonard::ping360 {
namespace {

std::string where_text(const PingForm& form) {
  return form.scan ? "scan " + scan_text(*form.scan) : fmt::format("angle {}", form.settings.angle);
}

}  // namespace

std::vector<std::uint8_t> recorded_wire(const PingForm& form, std::uint8_t device_id) {
  return encode(message_of(form, {}), device_id);
}

std::optional<PingForm> recorded_form(std::span<const std::uint8_t> wire) {
  const auto report = decode_report(wire);
  return report ? form_of(*report) : std::nullopt;
}

std::vector<Difference> differences(const PingForm& asked, const PingJob& sent, const PingForm& recorded) {
  std::vector<Difference> found;
  const DeviceData& wanted = asked.settings;
  const DeviceData& made = recorded.settings;
  const auto compare = [&](const char* kind, const char* text, int asked_for, int said) {
    if (asked_for != said) {
      found.push_back({kind, fmt::format(fmt::runtime(text), asked_for, said)});
    }
  };
  const double sample_m = sample_time_s(wanted.sample_period) * sent.sound_speed_mps / 2.0;
  const double range_m = wanted.number_of_samples * sample_m;
  if (std::abs(range_m - sent.range_m()) > std::max(sample_m, sent.bin_m())) {
    found.push_back(
        {"range", fmt::format("range {:.2f} m requested, {:.2f} m sent", range_m, sent.range_m())});
  }
  compare("samples", "{} samples requested, {} sent", wanted.number_of_samples, sent.bins());
  compare("gain", "gain {} requested, {} sent", wanted.gain_setting, made.gain_setting);
  compare("pulse", "pulse of {} us requested, {} us sent", wanted.transmit_duration_us,
          made.transmit_duration_us);
  compare("frequency", "{} kHz requested, {} kHz sent", wanted.transmit_frequency_khz,
          made.transmit_frequency_khz);
  const std::string asked_where = where_text(asked);
  const std::string where = where_text(recorded);
  if (asked_where != where) {
    found.push_back(
        {asked.scan ? "scan" : "angle", fmt::format("{} requested, {} sent", asked_where, where)});
  }
  return found;
}

}  // namespace sonard::ping360
