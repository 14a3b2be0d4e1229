// SPDX-License-Identifier: Apache-2.0
// Useless stamps, with arrival times set by hand.
#include "server/pose/stamp_watch.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

using std::chrono::milliseconds;
using Looks = StampWatch::Looks;

class StampWatchTest : public testing::Test {
 protected:
  /// Observes poses every 20 ms, each `step_m` further along x. `stamp` maps a time to its stamp.
  template <class Stamp>
  Looks stream(int poses, double step_m, Stamp stamp) {
    for (int i = 0; i < poses; ++i) {
      now_ += milliseconds{20};
      sample_.time_ns = stamp(now_.count());
      sample_.T_world_vehicle.position_m.x += step_m;
      watch_.observe(sample_, now_);
    }
    return watch_.looks();
  }

  StampWatch watch_;
  TimePoint now_ = std::chrono::hours{5};
  pose::PoseSample sample_;
};

std::int64_t left_out(std::int64_t) {
  return 0;
}
std::int64_t good(std::int64_t now_ns) {
  return now_ns;
}
std::int64_t whole_seconds(std::int64_t now_ns) {
  return now_ns / 1'000'000'000 * 1'000'000'000;
}

TEST_F(StampWatchTest, NothingIsWrongBeforeThereArePosesAndWithGoodOnes) {
  EXPECT_EQ(watch_.looks(), Looks::good);
  EXPECT_EQ(stream(500, 0.02, good), Looks::good);
}

TEST_F(StampWatchTest, StampsThatAreLeftOutStandStill) {
  EXPECT_EQ(stream(20, 0.02, left_out), Looks::good) << "0.38 s tell nothing";
  EXPECT_EQ(stream(10, 0.02, left_out), Looks::stand_still);
}

TEST_F(StampWatchTest, SoDoOthersThatAreAllAlike) {
  const auto alike = [](std::int64_t) { return std::int64_t{1'732'800'000'123'456'789}; };
  EXPECT_EQ(stream(60, 0.02, alike), Looks::good) << "they may count seconds";
  EXPECT_EQ(stream(20, 0.02, alike), Looks::stand_still);
}

TEST_F(StampWatchTest, SoDoThoseOfAVehicleThatOnlyTurns) {
  for (int i = 0; i < 50; ++i) {  // 10 degrees per second
    const double half_rad = 0.5 * 0.0035 * i;
    sample_.T_world_vehicle.orientation = {std::cos(half_rad), 0, 0, std::sin(half_rad)};
    stream(1, 0.0, left_out);
  }
  EXPECT_EQ(watch_.looks(), Looks::stand_still);
}

TEST_F(StampWatchTest, StampsThatStopLaterDoToo) {
  stream(100, 0.02, good);
  const std::int64_t last_ns = now_.count();
  EXPECT_EQ(stream(100, 0.02, [last_ns](std::int64_t) { return last_ns; }), Looks::stand_still);
  EXPECT_EQ(stream(2, 0.02, good), Looks::good) << "they go on";
}

TEST_F(StampWatchTest, APausedSimulationIsGood) {
  stream(100, 0.02, good);
  const std::int64_t paused_ns = now_.count();
  EXPECT_EQ(stream(500, 0.0, [paused_ns](std::int64_t) { return paused_ns; }), Looks::good);
  EXPECT_EQ(stream(10, 0.02, good), Looks::good);
}

TEST_F(StampWatchTest, AVehicleAtRestWhoseStampsNeverMovedIsToldFromOneThatMoves) {
  EXPECT_EQ(stream(90, 0.0, left_out), Looks::good);
  EXPECT_EQ(stream(60, 0.0, left_out), Looks::never_moved);
  EXPECT_EQ(stream(60, 0.02, left_out), Looks::stand_still);
}

TEST_F(StampWatchTest, WholeSecondsGoOnInSteps) {
  EXPECT_EQ(stream(225, 0.02, whole_seconds), Looks::in_steps);
  EXPECT_EQ(watch_.last_step(), milliseconds{980});  // from the first to the last pose within a second
  EXPECT_EQ(stream(60, 0.02, good), Looks::good);
}

std::int64_t tenths(std::int64_t now_ns) {
  return now_ns / 100'000'000 * 100'000'000;
}

TEST_F(StampWatchTest, TenthsOfASecondGoOnInSteps) {
  EXPECT_EQ(stream(50, 0.02, tenths), Looks::in_steps);
  EXPECT_EQ(watch_.last_step(), milliseconds{80});
}

TEST_F(StampWatchTest, PhysicsThatIsSlowerThanTheMessagesIsGood) {
  // At 10 Hz five messages repeat a pose with its stamp.
  stream(4, 0.0, tenths);
  for (int i = 0; i < 100; ++i) {
    stream(1, 0.1, tenths);
    EXPECT_EQ(stream(4, 0.0, tenths), Looks::good);
  }
}

}  // namespace
}  // namespace sonard::server
