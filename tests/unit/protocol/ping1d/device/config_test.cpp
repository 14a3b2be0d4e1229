// SPDX-License-Identifier: Apache-2.0
// Settings of a simulated head that its constructor refuses.
#include <functional>
#include <stdexcept>

#include "tests/unit/protocol/ping1d/device/bench.hpp"

namespace sonard::ping1d {
namespace {

TEST(Ping1dConfig, ValuesOutOfRangeAreNamed) {
  const std::vector<std::pair<std::string, std::function<void(DeviceConfig&)>>> bad{
      {"id", [](DeviceConfig& c) { c.id = 255; }},
      {"device_revision", [](DeviceConfig& c) { c.information.device_revision = 0; }},
      {"water_sound_speed_mps", [](DeviceConfig& c) { c.water_sound_speed_mps = 0.0; }},
      {"points", [](DeviceConfig& c) { c.points = 0; }},
      {"scan_length_mm", [](DeviceConfig& c) { c.scan_length_mm = 999; }},
      {"gain_setting", [](DeviceConfig& c) { c.gain_setting = 7; }},
      {"auto_lengths_m",
       [](DeviceConfig& c) {
         c.auto_lengths_m = {5, 5};
       }},
      {"auto_lengths_m", [](DeviceConfig& c) { c.auto_lengths_m.clear(); }},
      {"auto_target", [](DeviceConfig& c) { c.auto_target = 0.9; }},
      {"confidence_window", [](DeviceConfig& c) { c.confidence_window = 0; }},
      {"time_scale", [](DeviceConfig& c) { c.time_scale = -1.0; }},
      {"max_clients", [](DeviceConfig& c) { c.max_clients = 1; }},
      {"lock_to_first", [](DeviceConfig& c) { c.lock_to_first = true, c.idle_timeout = 0ns; }}};
  for (const auto& [field, spoil] : bad) {
    DeviceConfig config;
    spoil(config);
    try {
      Device device(config, 0ns);
      ADD_FAILURE() << field;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
  }
}

TEST(Ping1dConfig, ALockedHeadObeysTheFirstClientOnly) {
  DeviceConfig config;
  config.lock_to_first = true;
  Bench bench(config);
  const Peer stranger{0, {0x7F000002, 4000}, 0};
  EXPECT_EQ(bench.get<ModeAuto>(), ModeAuto{1});
  EXPECT_TRUE(bench.ask(SetModeAuto{0}, stranger).empty());
  EXPECT_EQ(bench.get<ModeAuto>(), ModeAuto{1});
}

}  // namespace
}  // namespace sonard::ping1d
