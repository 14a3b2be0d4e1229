// SPDX-License-Identifier: Apache-2.0
// Configurations that the head refuses.
#include <functional>
#include <stdexcept>
#include <string>

#include "bench.hpp"

namespace sonard::ping360 {
namespace {

/// The error message for the default head with one change; empty if the head accepts it.
std::string complaint(const std::function<void(DeviceConfig&)>& change) {
  DeviceConfig config;
  change(config);
  try {
    const Device device(config, 0ns);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Ping360DeviceConfig, NamesTheFieldThatIsOutOfRange) {
  EXPECT_EQ(complaint([](DeviceConfig&) {}), "");
  EXPECT_EQ(complaint([](DeviceConfig& c) { c.id = 0; }), "ping360 device: id must be 1..254");
  EXPECT_EQ(complaint([](DeviceConfig& c) { c.id = 255; }), "ping360 device: id must be 1..254");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.information.device_revision = 0; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.water_sound_speed_mps = 0.0; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.bearing_offset = 400; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.bearing_offset = -1; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.ping_overhead = -1ns; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.time_per_gradian = -1ns; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.time_scale = -0.1; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.idle_timeout = -1ns; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.reset_silence = -1ns; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.bootloader_silence = -1ns; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.max_clients = 1; }), "");
  EXPECT_EQ(complaint([](DeviceConfig& c) { c.time_scale = 0.0; }), "");
  EXPECT_EQ(complaint([](DeviceConfig& c) { c.queue_length = 0; }), "");
}

}  // namespace
}  // namespace sonard::ping360
