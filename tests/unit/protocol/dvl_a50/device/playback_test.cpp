// SPDX-License-Identifier: Apache-2.0
// A ping from the device to its record and back.
#include "protocol/dvl_a50/recorded_form.hpp"
#include "tests/unit/protocol/dvl_a50/device/bench.hpp"

namespace sonard::dvl_a50 {
namespace {

TEST(DvlPlayback, ARecordedReportIsSentAgainWithTheTimesOfToday) {
  Bench live;
  live.run_for(3s);
  ASSERT_FALSE(live.records.empty());
  const PingRecord& record = live.records.back();
  EXPECT_EQ(record.settings.bins, 200);
  EXPECT_EQ(std::ranges::count(record.samples, 255), 1) << "the four beams have the same distance";

  DeviceConfig config = quiet();
  config.plays_back = true;
  Bench player(config);
  ReplayedPing ping{.record = 5, .settings = record.settings, .wire = record.wire, .due = {}};
  player.step(PingFed{ping});
  ASSERT_EQ(player.jobs.size(), 1U);
  EXPECT_EQ(player.jobs[0].record, 5U);
  player.run_for(1s);
  ASSERT_EQ(player.velocities.size(), 1U);
  const Velocity& again = player.velocities[0].report;
  const Velocity& first = live.velocities.back().report;
  EXPECT_EQ(again.velocity_mps, first.velocity_mps);
  EXPECT_EQ(again.beams, first.beams);
  EXPECT_EQ(again.covariance, first.covariance);
  EXPECT_EQ(player.records.at(0).samples, test_image(player.jobs[0], 200).u8) << "what was fed";
  EXPECT_EQ(again.transmission_us, (1767225600s + player.velocities[0].time) / 1us);
}

TEST(DvlPlayback, WhatIsNoReportIsNotSent) {
  EXPECT_FALSE(recorded_form({}));
  const std::string position = R"({"type":"position_local"})";
  EXPECT_FALSE(recorded_form(std::vector<std::uint8_t>(position.begin(), position.end())));
}

}  // namespace
}  // namespace sonard::dvl_a50
