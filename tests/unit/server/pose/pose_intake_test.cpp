// SPDX-License-Identifier: Apache-2.0
// Poses that wait for pings in lock-step, and poses that do not wait.
#include "server/pose/pose_intake.hpp"

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <boost/asio/io_context.hpp>

namespace sonard::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

PoseConfig kept_by(PingClock clock) {
  PoseConfig config;
  config.clock = clock;
  return config;
}

struct PoseIntakeTest : testing::Test {
  boost::asio::io_context io;
  PoseHistory poses{kept_by(PingClock::simulated_lock_step)};
  std::optional<nanoseconds> lead;
  int changes = 0;
  PoseIntake intake{io, poses, {[this] { ++changes; }, [this] { return lead; }}};

  PoseIntakeTest() { spdlog::set_level(spdlog::level::off); }
  ~PoseIntakeTest() override { spdlog::set_level(spdlog::level::info); }

  void pose(std::int64_t time_ms) {
    pose::PoseSample sample;
    sample.time_ns = time_ms * 1'000'000;
    intake.take(sample, nanoseconds{0});
  }
  std::int64_t newest_ms() const { return poses.newest()->count() / 1'000'000; }
  void run_a_little() { io.run_for(milliseconds{20}), io.restart(); }
};

TEST_F(PoseIntakeTest, PosesPassAtOnce) {
  lead = milliseconds{100};
  pose(1000);
  pose(1010);
  EXPECT_EQ(newest_ms(), 1010);
  EXPECT_EQ(changes, 2);
}

TEST_F(PoseIntakeTest, PublishersWaitWhenPosesAreFarAhead) {
  pose(1000);
  EXPECT_FALSE(intake.hold()) << "nobody wants pings";
  lead = PoseIntake::most_ahead;
  EXPECT_FALSE(intake.hold());
  lead = PoseIntake::most_ahead + nanoseconds{1};
  EXPECT_TRUE(intake.hold());
  poses = PoseHistory{kept_by(PingClock::simulated)};
  EXPECT_FALSE(intake.hold()) << "only in lock-step";
}

TEST_F(PoseIntakeTest, AClockThatIsSetBackWaitsForThePingsOfBefore) {
  pose(1000);
  pose(2000);
  lead = nanoseconds{0};  // one ping could begin
  pose(0);
  pose(10);
  run_a_little();
  EXPECT_EQ(newest_ms(), 2000);
  EXPECT_TRUE(intake.hold());
  lead = nanoseconds{-1};
  run_a_little();
  EXPECT_EQ(newest_ms(), 10);
  EXPECT_EQ(changes, 4);
  EXPECT_FALSE(intake.hold());
}

TEST_F(PoseIntakeTest, AndSoDoesTheOneAfterThat) {
  pose(2000);
  lead = nanoseconds{0};
  pose(0);
  pose(1000);
  pose(0);  // the clock starts again
  lead.reset();
  run_a_little();
  EXPECT_EQ(newest_ms(), 0);
  EXPECT_EQ(poses.counters().clock_restarts, 2U);
}

TEST_F(PoseIntakeTest, OutsideLockStepNothingWaits) {
  poses = PoseHistory{kept_by(PingClock::simulated)};
  lead = milliseconds{100};
  pose(2000);
  pose(0);
  EXPECT_EQ(newest_ms(), 0);
}

TEST_F(PoseIntakeTest, StoppedItLeavesNothingBehind) {
  pose(2000);
  lead = nanoseconds{0};
  pose(0);
  intake.stop();
  lead.reset();
  run_a_little();
  EXPECT_EQ(newest_ms(), 2000);
}

}  // namespace
}  // namespace sonard::server
