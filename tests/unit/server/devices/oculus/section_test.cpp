// SPDX-License-Identifier: Apache-2.0
// Values and warnings of the loader for a head of type oculus.
#include "server/devices/oculus/section.hpp"

#include <chrono>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/devices/oculus/type.hpp"
#include "tests/support/degree.hpp"
#include "tests/unit/server/config/config_text.hpp"

namespace sonard::server {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class OculusSection : public ConfigFolder {
 protected:
  static std::string document(const std::string& head) {
    return "world: {file: world.sdf}\nwater: {temperature_c: 12, salinity_ppt: 35, depth_m: 30}\nposes:\n"
           "  initial: {position_m: [1, 2, 3]}\nheads:\n  - {type: oculus, name: bow, " +
           head + "}\n";
  }
  static std::string with_network(const std::string& more = "") {
    return "network: {address: 127.0.0.3, netmask: 255.0.0.0, status: [127.0.0.1]}" +
           (more.empty() ? "" : ", " + more);
  }
  HeadConfig read(const std::string& head) const { return load(document(head)).config.heads.at(0); }
};

TEST_F(OculusSection, GivesDefaultsForWhatIsLeftOut) {
  const LoadedConfig loaded = load(document(with_network()));
  EXPECT_THAT(loaded.warning_lines(), ElementsAre(HasSubstr("1200 kHz is not within 0.2 to 1000 kHz")));
  const HeadConfig& head = loaded.config.heads.at(0);
  EXPECT_EQ(head.type, &oculus_type());
  const OculusConfig& config = device_settings<OculusConfig>(head);
  EXPECT_EQ(config.device.plan.model.part_number, 1032);
  EXPECT_EQ(config.device.id, 7892);
  EXPECT_EQ(address_text(config.device.address), "127.0.0.3");
  EXPECT_EQ(config.tcp_port, 52100);
  EXPECT_EQ(config.status_port, 52102);
  EXPECT_THAT(config.device.mac, ElementsAre(0x00, 0x1E, 0x63, 0x00, 7892 >> 8, 7892 & 0xFF));
  EXPECT_EQ(config.device.plan.temperature_c, 12.0);
  EXPECT_NEAR(config.device.plan.pressure_bar, 4.013, 1e-9);
  EXPECT_TRUE(config.device.plan.reports_version_1);
  EXPECT_EQ(config.device.plan.heading_sign, 1);
  EXPECT_EQ(config.device.plan.pitch_sign, 1);
  EXPECT_EQ(config.device.plan.roll_sign, 1);
  EXPECT_EQ(config.device.plan.surface_pressure_bar, 1.013);
  EXPECT_NEAR(config.modes[0].receive_beamwidth_rad, 1.0 * degree, 1e-12);
  EXPECT_EQ(head.type->summary(head),
            "ID 7892, part 1032, TCP 127.0.0.3:52100, status to 127.0.0.1, port 52102");
  const auto sockets = head.type->sockets(head);
  ASSERT_EQ(sockets.size(), 1U);
  EXPECT_EQ(sockets[0].transport, PlannedSocket::Transport::tcp);
}

TEST_F(OculusSection, ReadsWhatIsWritten) {
  const HeadConfig head = read(
      "model: m1200d, device_id: 9, network: {address: 127.0.0.4, netmask: 255.0.0.0, tcp_port: 1, "
      "status_port: 2, "
      "mac: '00:01:02:03:04:05', status: directed_broadcast, allow: [127.0.0.0/8]}, timing: "
      "{status_period_ms: "
      "500, dummy_period_ms: 2000, ping_overhead_ms: 1}, firmware: {most_ranges: 800, "
      "rescales_high_frequency_gain: false, reports_sound_speed_used: false, reports_version_1: false, "
      "heading: "
      "counter_clockwise, pitch: nose_down, roll: zero, pressure: gauge, log_text: hello}, acoustics: "
      "{vertical_beamwidth_deg: 19, receive_beamwidth_deg: 0.7, aperture_deg: 120, range_cell_mm: 3, "
      "gain_db_per_percent: 0.5, high_frequency: {aperture_deg: 50, vertical_beamwidth_deg: 11, "
      "receive_beamwidth_deg: 0.3, range_cell_mm: 2}}");
  const OculusConfig& config = device_settings<OculusConfig>(head);
  EXPECT_EQ(config.device.id, 9);
  EXPECT_EQ(config.tcp_port, 1);
  EXPECT_EQ(config.status_port, 2);
  EXPECT_EQ(config.status.mode, StatusDestination::Mode::directed_broadcast);
  EXPECT_EQ(config.device.status_period, 500ms);
  EXPECT_EQ(config.device.dummy_period, 2s);
  EXPECT_EQ(config.device.plan.ping_overhead, 1ms);
  EXPECT_EQ(config.device.plan.most_ranges, 800);
  EXPECT_FALSE(config.device.plan.rescales_high_frequency_gain);
  EXPECT_FALSE(config.device.plan.reports_sound_speed_used);
  EXPECT_FALSE(config.device.plan.reports_version_1);
  EXPECT_EQ(config.device.plan.heading_sign, -1);
  EXPECT_EQ(config.device.plan.pitch_sign, -1);
  EXPECT_EQ(config.device.plan.roll_sign, 0);
  EXPECT_EQ(config.device.plan.surface_pressure_bar, 0.0);
  EXPECT_NEAR(config.device.plan.pressure_bar, 3.0, 1e-9);
  EXPECT_EQ(config.device.log_text, "hello");
  const oculus::Model& model = config.device.plan.model;
  EXPECT_EQ(model.part_number, 1042);
  EXPECT_EQ(model.modes[0].horizontal_deg, 120.0);
  EXPECT_EQ(model.modes[1].horizontal_deg, 50.0);
  EXPECT_NEAR(config.modes[0].vertical_beamwidth_rad, 19 * degree, 1e-12);
  EXPECT_NEAR(config.modes[0].receive_beamwidth_rad, 0.7 * degree, 1e-12);
  EXPECT_NEAR(config.modes[0].range_cell_m, 3e-3, 1e-12);
  EXPECT_NEAR(config.modes[1].vertical_beamwidth_rad, 11 * degree, 1e-12);
  EXPECT_NEAR(config.modes[1].receive_beamwidth_rad, 0.3 * degree, 1e-12);
  EXPECT_NEAR(config.modes[1].range_cell_m, 2e-3, 1e-12);
  EXPECT_EQ(config.gain_db_per_percent, 0.5);
}

TEST_F(OculusSection, TheHighFrequencyMayHaveAnAbsorptionOfItsOwn) {
  const LoadedConfig loaded =
      load(document(with_network("acoustics: {high_frequency: {absorption_db_per_km: 480}}")));
  EXPECT_THAT(loaded.warning_lines(), IsEmpty()) << "the formula is valid at 750 kHz";
  const OculusConfig& config = device_settings<OculusConfig>(loaded.config.heads.at(0));
  EXPECT_NEAR(config.modes[1].absorption_db_per_m, 0.48, 1e-12);
  EXPECT_NEAR(config.modes[0].absorption_db_per_m, 0.2167, 0.0005);  // Francois and Garrison, by hand
}

TEST_F(OculusSection, AnAbsorptionThatIsSetHoldsAtBothFrequencies) {
  std::string text = document(with_network());
  text.replace(text.find("depth_m: 30"), 11, "depth_m: 30, absorption_db_per_km: 150");
  const HeadConfig head = load(text).config.heads.at(0);
  EXPECT_NEAR(device_settings<OculusConfig>(head).modes[0].absorption_db_per_m, 0.15, 1e-12);
  EXPECT_NEAR(device_settings<OculusConfig>(head).modes[1].absorption_db_per_m, 0.15, 1e-12);
  const OculusConfig computed = device_settings<OculusConfig>(read(with_network()));
  EXPECT_GT(computed.modes[1].absorption_db_per_m, 1.5 * computed.modes[0].absorption_db_per_m);
}

}  // namespace
}  // namespace sonard::server
