// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/device_config.hpp"

#include <stdexcept>

#include "protocol/dvl_a50/codec.hpp"

namespace sonard::dvl_a50 {

const DeviceConfig& validated(const DeviceConfig& config) {
  const auto require = [](bool condition, const char* what) {
    if (!condition) {
      throw std::invalid_argument(std::string("dvl_a50 device: ") + what);
    }
  };
  require(!wrong_setting(config.settings, config.release), "settings are out of range");
  require(config.water_sound_speed_mps > 0.0, "water_sound_speed_mps must be positive");
  require(config.most_speed_mps > 0.0, "most_speed_mps must be positive");
  require(config.most_water_speed_mps > 0.0, "most_water_speed_mps must be positive");
  require(config.beam_noise_mps >= 0.0, "beam_noise_mps must not be negative");
  require(config.beam_noise_factor >= 0.0, "beam_noise_factor must not be negative");
  require(config.distance_steps_hz > 0.0, "distance_steps_hz must be positive");
  require(config.position_noise_m >= 0.0, "position_noise_m must not be negative");
  require(config.water_rate_hz > 0.0, "water_rate_hz must be positive");
  for (const RangeMode& mode : config.range_modes) {
    require(mode.least_m >= 0.0 && mode.most_m > mode.least_m && mode.rate_hz > 0.0,
            "range_modes must have limits that rise and a rate");
  }
  require(config.time_scale >= 0.0 && config.time_scale <= 1000.0, "time_scale must be 0..1000");
  require(config.search_interval > std::chrono::nanoseconds{0}, "search_interval must be positive");
  require(config.cycling_interval > std::chrono::nanoseconds{0}, "cycling_interval must be positive");
  require(config.processing_delay >= std::chrono::nanoseconds{0}, "processing_delay must not be negative");
  require(config.calibration_time >= std::chrono::nanoseconds{0}, "calibration_time must not be negative");
  return config;
}

}  // namespace sonard::dvl_a50
