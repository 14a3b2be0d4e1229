// SPDX-License-Identifier: Apache-2.0
// Values and warnings of the loader for a head of type ping360.
#include "server/devices/ping360/section.hpp"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/devices/ping360/type.hpp"
#include "tests/unit/server/config/config_text.hpp"

namespace sonard::server {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Ping360Section : public ConfigFolder {
 protected:
  static std::string document(const std::string& head) {
    return "world: {file: world.sdf}\nposes:\n  initial: {position_m: [1, 2, 3]}\nheads:\n  - {type: "
           "ping360, " +
           head + "}\n";
  }
  Ping360Config read(const std::string& head) const {
    return device_settings<Ping360Config>(load(document(head)).config.heads.at(0));
  }
};

TEST_F(Ping360Section, GivesDefaultsForWhatIsLeftOut) {
  const LoadedConfig loaded = load(document("name: mast, udp: [{bind: 127.0.0.1:12345}]"));
  EXPECT_THAT(loaded.warning_lines(), IsEmpty());
  const HeadConfig& head = loaded.config.heads.at(0);
  EXPECT_EQ(head.type, &ping360_type());
  const Ping360Config& config = device_settings<Ping360Config>(head);
  ASSERT_EQ(config.udp.size(), 1U);
  EXPECT_EQ(endpoint_text(config.udp[0].bind), "127.0.0.1:12345");
  EXPECT_EQ(config.device.id, 2);
  EXPECT_EQ(config.device.serial_channel, -1);
  EXPECT_EQ(config.device.idle_timeout, 0ns);
  EXPECT_FALSE(config.discovery);
  EXPECT_EQ(head.type->summary(head), "ID 2, UDP 127.0.0.1:12345");
}

TEST_F(Ping360Section, ReadsWhatIsWritten) {
  const Ping360Config config = read(
      "name: mast, udp: [{bind: 127.0.0.1:12345}, {bind: 127.0.0.1:9092}], serial: {pty: [{}]}, "
      "discovery: {bind: 0.0.0.0:30303, allow: [192.168.2.0/24], address: 192.168.2.4, mac: "
      "'54:10:ec:79:7d:c5'}, "
      "device: {id: 7, firmware_minor: 2, bearing_offset: 200, fan_out: all, max_datagram: 1000}, "
      "lock_to_first: on, "
      "timing: {ping_overhead_ms: 1.5, gradian_ms: 2, scale: 0.5, idle_timeout_ms: 30000}");
  ASSERT_EQ(config.udp.size(), 2U);
  EXPECT_EQ(config.device.serial_channel, 2) << "behind the sockets";
  ASSERT_TRUE(config.discovery);
  EXPECT_EQ(address_text(config.discovery->address), "192.168.2.4");
  EXPECT_THAT(config.discovery->mac, ElementsAre(0x54, 0x10, 0xEC, 0x79, 0x7D, 0xC5));
  EXPECT_EQ(config.device.id, 7);
  EXPECT_EQ(config.device.information.firmware_minor, 2);
  EXPECT_EQ(config.device.bearing_offset, 200);
  EXPECT_EQ(config.device.fan_out, ping360::FanOut::all);
  EXPECT_EQ(config.device.max_datagram, 1000U);
  EXPECT_EQ(config.device.ping_overhead, 1500us);
  EXPECT_EQ(config.device.time_per_gradian, 2ms);
  EXPECT_EQ(config.device.time_scale, 0.5);
  EXPECT_EQ(config.device.idle_timeout, 30s);
  EXPECT_TRUE(config.device.lock_to_first);
  EXPECT_TRUE(config.serial.lock_to_first);
}

TEST_F(Ping360Section, ABeamwidthIsThatOfTheOneBeam) {
  const std::string text = document("name: m, udp: [{bind: 127.0.0.1:1}], acoustics: {beamwidth_deg: 3}");
  const render::Aperture aperture = load(text).config.heads.at(0).acoustics.aperture;
  const double half_rad = 1.5 * std::numbers::pi / 180.0;
  EXPECT_NEAR(aperture.receive_beamwidth_rad, 2.0 * half_rad, 1e-12);
  ASSERT_EQ(aperture.beam_edges_rad.size(), 2U);
  EXPECT_NEAR(aperture.beam_edges_rad[0], half_rad, 1e-12);
  EXPECT_NEAR(aperture.beam_edges_rad[1], -half_rad, 1e-12);
}

TEST_F(Ping360Section, ATransducerBandHasTwoEndsOrNone) {
  const std::string head = "name: m, udp: [{bind: 127.0.0.1:1}], acoustics: {transducer_band: ";
  EXPECT_EQ(read(head + "{low_khz: 700, high_khz: 780}}").transducer_band,
            (render::TransducerBand{700e3, 780e3}));
  EXPECT_EQ(read(head + "{low_khz: 0, high_khz: 0}}").transducer_band, render::TransducerBand{});
  EXPECT_EQ(read("name: m, udp: [{bind: 127.0.0.1:1}]").transducer_band,
            (render::TransducerBand{650e3, 850e3}));
}

}  // namespace
}  // namespace sonard::server
