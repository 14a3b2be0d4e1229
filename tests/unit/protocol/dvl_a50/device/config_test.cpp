// SPDX-License-Identifier: Apache-2.0
#include <functional>
#include <stdexcept>

#include "tests/unit/protocol/dvl_a50/device/bench.hpp"

namespace sonard::dvl_a50 {
namespace {

TEST(DvlConfig, ValuesOutOfRangeAreNamed) {
  const std::pair<const char*, std::function<void(DeviceConfig&)>> cases[] = {
      {"settings", [](DeviceConfig& c) { c.settings.range_mode = "=7"; }},
      {"water_sound_speed_mps", [](DeviceConfig& c) { c.water_sound_speed_mps = 0; }},
      {"most_speed_mps", [](DeviceConfig& c) { c.most_speed_mps = -1; }},
      {"beam_noise_mps", [](DeviceConfig& c) { c.beam_noise_mps = -1; }},
      {"range_modes", [](DeviceConfig& c) { c.range_modes[2].rate_hz = 0; }},
      {"time_scale", [](DeviceConfig& c) { c.time_scale = 1001; }},
      {"search_interval", [](DeviceConfig& c) { c.search_interval = 0ns; }},
      {"processing_delay", [](DeviceConfig& c) { c.processing_delay = -1ns; }}};
  EXPECT_NO_THROW(Device(DeviceConfig(), 0ns));
  for (const auto& [name, spoil] : cases) {
    DeviceConfig config;
    spoil(config);
    try {
      Device device(config, 0ns);
      ADD_FAILURE() << name;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
}

TEST(DvlConfig, AnA125LooksFarther) {
  DeviceConfig config = quiet();
  const DeviceConfig a125(Model::a125);
  config.range_modes = a125.range_modes;
  Bench bench(config);
  bench.height_m = 110.0;
  bench.run_for(5s);
  EXPECT_TRUE(bench.velocities.back().report.valid);
  EXPECT_EQ(a125.product_name, "DVL A125");
}

}  // namespace
}  // namespace sonard::dvl_a50
