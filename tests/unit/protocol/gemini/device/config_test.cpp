// SPDX-License-Identifier: Apache-2.0
// Configurations that the head refuses.
#include <functional>
#include <stdexcept>
#include <string>

#include "bench.hpp"

namespace sonard::gemini {
namespace {

/// The error message for the example head with one change; empty if the head accepts it.
std::string complaint(const std::function<void(DeviceConfig&)>& change) {
  DeviceConfig config = example_config();
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
  EXPECT_EQ(complaint([](DeviceConfig& c) { c.sonar_id = 1; }), "gemini device: sonar_id must be at least 2");
  EXPECT_EQ(complaint([](DeviceConfig& c) { c.alternate_address = 0; }),
            "gemini device: alternate_address must not be 0.0.0.0");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.line_period = 0ns; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.burst_lines = 0; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.min_ping_period = 0ns; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.status_period = 0ns; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.water_sound_speed_mps = -1.0; }), "");
  EXPECT_NE(complaint([](DeviceConfig& c) { c.gain.reference_spreading = 0.0; }), "");
}

}  // namespace
}  // namespace sonard::gemini
