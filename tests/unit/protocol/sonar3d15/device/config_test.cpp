// SPDX-License-Identifier: Apache-2.0
// Settings that no head can have, each with the field that the error names.
#include <gtest/gtest.h>

#include <functional>

#include "protocol/sonar3d15/device.hpp"

namespace sonard::sonar3d15 {
namespace {

TEST(Config, TheErrorNamesTheField) {
  using namespace std::chrono_literals;
  const std::pair<const char*, std::function<void(DeviceConfig&)>> wrong[] = {
      {"rate_hz", [](DeviceConfig& config) { config.low.rate_hz = 0.0; }},
      {"latency", [](DeviceConfig& config) { config.high.latency = -1ns; }},
      {"field of view", [](DeviceConfig& config) { config.high.vertical_fov_deg = 161.0; }},
      {"carrier_hz", [](DeviceConfig& config) { config.low.carrier_hz = 0.0; }},
      {"unicast", [](DeviceConfig& config) { config.udp_mode = UdpMode::unicast; }},
      {"most_range_m", [](DeviceConfig& config) { config.most_range_m = 51.0; }},
      {"range_m", [](DeviceConfig& config) { config.range_m = 17.0; }},
      {"range_m", [](DeviceConfig& config) { config.least_range_m = 15.0; }},
      {"columns", [](DeviceConfig& config) { config.columns = 1; }},
      {"rows", [](DeviceConfig& config) { config.rows = 79; }},
      {"time_scale", [](DeviceConfig& config) { config.time_scale = -0.1; }},
      {"pixel_scale_m", [](DeviceConfig& config) { config.pixel_scale_m = 0.0; }},
      {"range_step_s", [](DeviceConfig& config) { config.range_step_s = 0.0; }},
      {"gain", [](DeviceConfig& config) { config.gain = 0.0; }},
      {"threshold", [](DeviceConfig& config) { config.threshold = 29.0; }},
      {"range_bin_m", [](DeviceConfig& config) { config.range_bin_m = 0.0; }},
      {"speed_change_time", [](DeviceConfig& config) { config.speed_change_time = -1ns; }},
      {"imu noise", [](DeviceConfig& config) { config.imu_rate_noise_radps = -0.1; }},
      {"imu_batch_samples", [](DeviceConfig& config) { config.imu_batch_samples = 1001; }},
      {"speed of sound", [](DeviceConfig& config) { config.water_sound_speed_mps = 0.0; }}};
  EXPECT_NO_THROW((Device{DeviceConfig{}, TimePoint{}}));
  for (const auto& [field, spoil] : wrong) {
    DeviceConfig config;
    spoil(config);
    try {
      const Device device(config, TimePoint{});
      ADD_FAILURE() << field;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace sonard::sonar3d15
