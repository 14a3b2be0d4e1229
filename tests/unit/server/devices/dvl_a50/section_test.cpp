// SPDX-License-Identifier: Apache-2.0
// Values of the loader for a head of type dvl_a50.
#include "server/devices/dvl_a50/section.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/devices/dvl_a50/type.hpp"
#include "tests/unit/server/config/config_text.hpp"

namespace sonard::server {
namespace {

using namespace std::chrono_literals;
using testing::IsEmpty;

class DvlSection : public ConfigFolder {
 protected:
  static std::string document(const std::string& head) {
    return "world: {file: world.sdf}\nposes:\n  initial: {position_m: [1, 2, 3]}\nheads:\n  - {type: "
           "dvl_a50, " +
           head + "}\n";
  }
  HeadConfig read(const std::string& head) const { return load(document(head)).config.heads.at(0); }
};

TEST_F(DvlSection, GivesDefaultsForWhatIsLeftOut) {
  const LoadedConfig loaded = load(document("name: dvl, tcp: {bind: 127.0.0.1:16171}"));
  EXPECT_THAT(loaded.warning_lines(), IsEmpty());
  const HeadConfig& head = loaded.config.heads.at(0);
  EXPECT_EQ(head.type, &dvl_a50_type());
  const dvl_a50::DeviceConfig& device = device_settings<DvlConfig>(head).device;
  EXPECT_EQ(device.settings, dvl_a50::Settings{});
  EXPECT_EQ(device.release, dvl_a50::Release::v2_7_2);
  EXPECT_EQ(device.pd6_channel, -1);
  EXPECT_EQ(device.serial_channel, -1);
  EXPECT_EQ(head.type->summary(head), "DVL A50, JSON 127.0.0.1:16171");
  EXPECT_EQ(head.type->sockets(head).size(), 1U);
}

TEST_F(DvlSection, ChannelsFollowTheSocketsThatAreGiven) {
  const HeadConfig head = read(
      "name: dvl, model: a125, tcp: {bind: 127.0.0.1:16171}, pd4: {bind: 127.0.0.1:1038}, http: {bind: "
      "127.0.0.1:8080}, serial: {pty: [{}]}");
  const dvl_a50::DeviceConfig& device = device_settings<DvlConfig>(head).device;
  EXPECT_EQ(device.pd6_channel, -1);
  EXPECT_EQ(device.pd4_channel, 1);
  EXPECT_EQ(device.http_channel, 2);
  EXPECT_EQ(device.serial_channel, 3);
  EXPECT_EQ(device.product_name, "DVL A125");
  EXPECT_EQ(device.range_modes[4].most_m, 125.0);
}

TEST_F(DvlSection, ReadsWhatIsWritten) {
  const HeadConfig head = read(
      "name: dvl, tcp: {bind: 127.0.0.1:16171}, initial: {speed_of_sound_mps: 1500, acoustic_enabled: false, "
      "mounting_rotation_offset_deg: 90, range_mode: 1<=3, periodic_cycling_enabled: false}, device: "
      "{release: 2.4.0, "
      "line_end: lf, beam_noise_mps: 0, water_current_mps: [1, 2, 3], seed: 7}, timing: {scale: 0.5, "
      "search_interval_ms: 500, processing_delay_ms: 20}");
  const dvl_a50::DeviceConfig& device = device_settings<DvlConfig>(head).device;
  EXPECT_EQ(device.settings, (dvl_a50::Settings{1500, false, false, 90, "1<=3", false}));
  EXPECT_EQ(device.release, dvl_a50::Release::v2_4_0);
  EXPECT_EQ(device.line_end, "\n");
  EXPECT_EQ(device.beam_noise_mps, 0.0);
  EXPECT_EQ(device.water_current_mps, (dvl_a50::Vector{1, 2, 3}));
  EXPECT_EQ(device.seed, 7U);
  EXPECT_EQ(device.time_scale, 0.5);
  EXPECT_EQ(device.search_interval, 500ms);
  EXPECT_EQ(device.processing_delay, 20ms);
}

}  // namespace
}  // namespace sonard::server
