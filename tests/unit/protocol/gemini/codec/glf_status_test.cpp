// SPDX-License-Identifier: Apache-2.0
// The expected values were calculated by hand from protocol/gemini/README.md and protocol/glf/README.md 1.5.
#include "protocol/gemini/glf_status.hpp"

#include <array>

#include <gtest/gtest.h>

#include "protocol/gemini/gain_law.hpp"

namespace sonard::gemini {
namespace {

TEST(GlfStatus, SaysHowTheHeadIs) {
  Status status;
  status.sonar_id = 513;
  status.alternate_ip = 0x7F000002;
  status.mac.octets = {0x00, 0x12, 0x34, 0x56, 0x78, 0x9A};
  status.vga2a_temperature = temperature_code(22.25);
  status.tx1_temperature = temperature_code(24.0);
  status.die_temperature = die_temperature_code(45.0);
  status.clock_us = 123'456'789'012;
  status.shutdown_status = 0x0004;
  const glf::StatusRecord record = glf_status(status);
  EXPECT_EQ(record.device_id, 513);
  EXPECT_EQ(record.bf_firmware_version, 0x0119);
  EXPECT_EQ(record.alternate_ip, 0x7F000002U);
  EXPECT_EQ(record.mac, (std::array<std::uint16_t, 3>{0x0012, 0x3456, 0x789A}));
  EXPECT_EQ(record.afe_c.at(2), 22.25);
  EXPECT_EQ(record.afe_c.at(0), 0.0);  // no sensor answers
  EXPECT_EQ(record.tx_c, 24.0);
  EXPECT_NEAR(record.die_c, 45.0, 0.25);
  EXPECT_EQ(record.fpga_time_us, 123'456'789'012U);
  EXPECT_EQ(record.shutdown_status, 0x0004);
  EXPECT_EQ(record.link_type, 0x1100);  // the link has negotiated Ethernet at 100 Mb/s
}

TEST(GainLaw, PercentIsWhatTheEarlyLibraryTurnsIntoSpreading) {
  // trunc(500 exp((g - 100) / 25))
  EXPECT_NEAR(gain_percent(67), 50.0, 0.4);
  EXPECT_NEAR(gain_percent(500), 100.0, 1e-9);
  EXPECT_NEAR(gain_percent(9), 0.0, 0.5);
  EXPECT_EQ(gain_percent(0), gain_percent(9));
  EXPECT_EQ(gain_percent(65'535), 100.0);
}

}  // namespace
}  // namespace sonard::gemini
