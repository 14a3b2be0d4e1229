// SPDX-License-Identifier: Apache-2.0
// Values of the loader for a head of type ping1d.
#include "server/devices/ping1d/section.hpp"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/devices/ping1d/type.hpp"
#include "tests/unit/server/config/config_text.hpp"

namespace sonard::server {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr double degree = std::numbers::pi / 180.0;

class Ping1dSection : public ConfigFolder {
 protected:
  static std::string document(const std::string& head) {
    return "world: {file: world.sdf}\nposes:\n  initial: {position_m: [1, 2, 3]}\nheads:\n  - {type: "
           "ping1d, " +
           head + "}\n";
  }
  HeadConfig read(const std::string& head) const { return load(document(head)).config.heads.at(0); }
};

TEST_F(Ping1dSection, GivesDefaultsForWhatIsLeftOut) {
  const LoadedConfig loaded = load(document("name: altimeter, udp: [{bind: 127.0.0.1:9090}]"));
  EXPECT_THAT(loaded.warning_lines(), IsEmpty());
  const HeadConfig& head = loaded.config.heads.at(0);
  EXPECT_EQ(head.type, &ping1d_type());
  const ping1d::DeviceConfig& device = device_settings<Ping1dConfig>(head).device;
  EXPECT_EQ(device.id, 1);
  EXPECT_EQ(device.information, (ping::DeviceInformation{1, 1, 3, 29, 0}));
  EXPECT_EQ(device.serial_channel, -1);
  EXPECT_EQ(device.idle_timeout, 30s);
  EXPECT_DOUBLE_EQ(device.least_range_m, 0.5);
  EXPECT_NEAR(head.acoustics.aperture.vertical_beamwidth_rad, 30 * degree, 1e-12);
  EXPECT_EQ(head.type->summary(head), "ID 1, UDP 127.0.0.1:9090");
}

TEST_F(Ping1dSection, TheModelSetsBeamLeastRangeAndRevision) {
  const HeadConfig head = read("name: altimeter, model: ping2, udp: [{bind: 127.0.0.1:9090}]");
  const ping1d::DeviceConfig& device = device_settings<Ping1dConfig>(head).device;
  EXPECT_EQ(device.information.device_revision, 2);
  EXPECT_DOUBLE_EQ(device.least_range_m, 0.3);
  EXPECT_NEAR(head.acoustics.aperture.vertical_beamwidth_rad, 25 * degree, 1e-12);
  EXPECT_NEAR(head.acoustics.aperture.beam_edges_rad.front(), 12.5 * degree, 1e-12);
}

TEST_F(Ping1dSection, ReadsWhatIsWritten) {
  const HeadConfig head = read(
      "name: altimeter, udp: [{bind: 127.0.0.1:9090}, {bind: 127.0.0.1:6676}], serial: {pty: [{}]}, "
      "device: {id: 7, firmware_minor: 30, initial_length_mm: 20000, initial_interval_ms: 100, initial_gain: "
      "3, "
      "points: 400, auto_lengths_m: [5, 50], auto_target: 0.6, confidence_window: 2, pulse_us_per_m: 30, "
      "acknowledges: false, auto_refusal: silent, accepts_any_destination: true, fan_out: all}, "
      "lock_to_first: on, timing: {ping_overhead_ms: 1, scale: 0.5, idle_timeout_ms: 5000, bootloader_ms: "
      "100}, "
      "acoustics: {beamwidth_deg: 20, least_range_m: 0.4}");
  const ping1d::DeviceConfig& device = device_settings<Ping1dConfig>(head).device;
  EXPECT_EQ(device.serial_channel, 2) << "behind the sockets";
  EXPECT_EQ(device.id, 7);
  EXPECT_EQ(device.information.firmware_minor, 30);
  EXPECT_EQ(device.scan_length_mm, 20'000U);
  EXPECT_EQ(device.interval_ms, 100);
  EXPECT_EQ(device.gain_setting, 3);
  EXPECT_EQ(device.points, 400);
  EXPECT_THAT(device.auto_lengths_m, ElementsAre(5, 50));
  EXPECT_DOUBLE_EQ(device.auto_target, 0.6);
  EXPECT_EQ(device.confidence_window, 2);
  EXPECT_DOUBLE_EQ(device.pulse_us_per_m, 30);
  EXPECT_FALSE(device.acknowledges);
  EXPECT_TRUE(device.refuses_silently_in_auto);
  EXPECT_TRUE(device.accepts_any_destination);
  EXPECT_EQ(device.fan_out, ping::FanOut::all);
  EXPECT_TRUE(device.lock_to_first);
  EXPECT_EQ(device.ping_overhead, 1ms);
  EXPECT_DOUBLE_EQ(device.time_scale, 0.5);
  EXPECT_EQ(device.idle_timeout, 5s);
  EXPECT_EQ(device.bootloader_silence, 100ms);
  EXPECT_DOUBLE_EQ(device.least_range_m, 0.4);
  EXPECT_NEAR(head.acoustics.aperture.beam_edges_rad.front(), 10 * degree, 1e-12);
}

}  // namespace
}  // namespace sonard::server
