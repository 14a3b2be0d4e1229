// SPDX-License-Identifier: Apache-2.0
// Configurations that the head refuses.
#include <functional>
#include <stdexcept>
#include <string>

#include "bench.hpp"

namespace sonard::micron {
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

TEST(DeviceConfig, NamesTheFieldThatIsOutOfRange) {
  EXPECT_EQ(complaint([](DeviceConfig&) {}), "");
  EXPECT_EQ(complaint([](DeviceConfig& c) { c.node = 0; }), "micron device: node must be 1..254");
  EXPECT_EQ(complaint([](DeviceConfig& c) { c.node = 255; }), "micron device: node must be 1..254");
  EXPECT_EQ(complaint([](DeviceConfig& c) { c.least_centring_time = -1ns; }),
            "micron device: least_centring_time must be 0..15 s");
  EXPECT_EQ(complaint([](DeviceConfig& c) { c.least_centring_time = 15001ms; }),
            "micron device: least_centring_time must be 0..15 s");
  EXPECT_EQ(complaint([](DeviceConfig& c) { c.boot_time = 1s; }),
            "micron device: boot_time must be less than 1 s");
  EXPECT_EQ(complaint([](DeviceConfig& c) { c.boot_time = -1ns; }),
            "micron device: boot_time must be less than 1 s");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.water_sound_speed_mps = 0.0; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.seek_speed_rad_s = 0.0; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.alive_period = 0ns; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.request_cap = 0; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.request_cap = 101; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.reconfiguration_time = -1ns; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.reposition_limit = -1ns; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.baud = 0; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.line_overhead = -1ns; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.line_period = -1ns; }), "");
  EXPECT_EQ(complaint([](DeviceConfig& c) { c.line_period = 0ns; }), "");
}

}  // namespace
}  // namespace sonard::micron
