// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping360/limits.hpp"

#include <cstdint>
#include <initializer_list>

#include "protocol/ping360/units.hpp"

namespace sonard::ping360 {
namespace {

std::optional<OutOfRange> first_of(std::initializer_list<OutOfRange> fields) {
  for (const OutOfRange& field : fields) {
    if (field.value < field.least || field.value > field.most) {
      return field;
    }
  }
  return std::nullopt;
}

template <class Command>
std::optional<OutOfRange> ping_settings_out_of_range(const Command& command) {
  return first_of({{"gain_setting", command.gain_setting, 0, 2},
                   {"transmit_duration", command.transmit_duration_us, 1, 1000},
                   {"sample_period", command.sample_period, least_sample_period, most_sample_period},
                   {"transmit_frequency", command.transmit_frequency_khz, 500, 1000},
                   {"number_of_samples", command.number_of_samples, 1, 1200}});
}

}  // namespace

std::optional<OutOfRange> out_of_range(const Transducer& command, const DeviceConfig& config) {
  const auto setting = ping_settings_out_of_range(command);
  return setting ? setting : first_of({{"angle", command.angle, 0, config.accepts_angle_400 ? 400 : 399}});
}

std::optional<OutOfRange> out_of_range(const AutoTransmit& command, const DeviceConfig& config) {
  if (const auto setting = ping_settings_out_of_range(command)) {
    return setting;
  }
  const int most = config.signed_scan_angles ? UINT16_MAX : gradians_per_turn - 1;
  return first_of({{"start_angle", command.start_angle, 0, most},
                   {"stop_angle", command.stop_angle, 0, most},
                   {"num_steps", command.num_steps, 1, 10},
                   {"delay", command.delay_ms, 0, 100}});
}

int scan_angle(std::uint16_t angle, const DeviceConfig& config) {
  return wrapped(config.signed_scan_angles ? static_cast<std::int16_t>(angle) : int{angle});
}

}  // namespace sonard::ping360
