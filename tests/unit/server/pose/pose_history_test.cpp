// SPDX-License-Identifier: Apache-2.0
// The pose of a ping against closed-form motion.
#include "server/pose/pose_history.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace sonard::server {
namespace {

using pose::PoseSample;
using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::Field;

constexpr std::int64_t ms_ns = 1'000'000;
/// Our clock minus the publisher's clock.
constexpr nanoseconds offset = seconds{1000};

PoseConfig config(StalePolicy policy = StalePolicy::hold) {
  PoseConfig result;
  result.extrapolation_limit = milliseconds{200};
  result.stale_policy = policy;
  return result;
}

PoseSample at_x(std::int64_t time_ms, double x_m) {
  PoseSample sample;
  sample.time_ns = time_ms * ms_ns;
  sample.T_world_vehicle.position_m = {x_m, 0, 0};
  return sample;
}

pose::Quat yaw(double angle_rad) {
  return {std::cos(angle_rad / 2), 0, 0, std::sin(angle_rad / 2)};
}

/// Time on our clock at which the publisher's clock shows `time_ms`.
TimePoint ours(double time_ms) {
  return offset + nanoseconds{std::llround(time_ms * 1e6)};
}

/// Inserts a sample that arrives without delay.
void insert(PoseHistory& history, const PoseSample& sample) {
  history.insert(sample, offset + nanoseconds{sample.time_ns});
}

double x_at(const PoseHistory& history, double time_ms) {
  const auto estimate = history.at(ours(time_ms));
  EXPECT_TRUE(estimate);
  return estimate ? estimate->T_world_vehicle.position_m.x : std::nan("");
}

PoseQuality quality_at(const PoseHistory& history, double time_ms) {
  const auto estimate = history.at(ours(time_ms));
  EXPECT_TRUE(estimate);
  return estimate ? estimate->quality : PoseQuality::initial;
}

TEST(PoseHistory, HasNoPoseBeforeTheFirst) {
  EXPECT_FALSE(PoseHistory{config()}.at(seconds{1}));
}

TEST(PoseHistory, InitialPoseHoldsUntilTheFirstAndIsNeverStale) {
  PoseConfig with_initial = config(StalePolicy::silence);
  with_initial.T_world_vehicle_initial = render::Pose{{7, 8, 9}, {1, 0, 0, 0}};
  PoseHistory history{with_initial};
  const auto before = history.at(hours{24 * 365});
  ASSERT_TRUE(before);
  EXPECT_EQ(before->quality, PoseQuality::initial);
  EXPECT_EQ(before->T_world_vehicle.position_m, glm::dvec3(7, 8, 9));
  insert(history, at_x(0, 1));
  EXPECT_EQ(x_at(history, 0), 1.0);
  EXPECT_FALSE(history.at(ours(201))) << "the first pose gets stale; the initial one does not come back";
}

TEST(PoseHistory, InterpolatesAStraightLine) {
  PoseHistory history{config()};
  for (int i = 0; i <= 10; ++i) {
    insert(history, at_x(20 * i, 0.03 * i));  // 1.5 m/s
  }
  for (const double t : {0.0, 3.0, 20.0, 59.99, 111.0, 200.0}) {
    EXPECT_NEAR(x_at(history, t), 1.5e-3 * t, 1e-12) << t;
    EXPECT_EQ(quality_at(history, t), PoseQuality::interpolated) << t;
  }
}

TEST(PoseHistory, InterpolatesAConstantTurn) {
  PoseHistory history{config()};
  const double rate_radps = 1.3;  // many turns, so the heading crosses +-180 degrees and q changes sign
  for (int i = 0; i <= 250; ++i) {
    PoseSample sample = at_x(20 * i, 0);
    sample.T_world_vehicle.orientation = yaw(rate_radps * 0.02 * i);
    if (i % 3 == 0) {
      pose::Quat& q = sample.T_world_vehicle.orientation;
      q = {-q.w, -q.x, -q.y, -q.z};
    }
    insert(history, sample);
  }
  for (const double t : {0.0, 7.0, 2416.6, 4833.3, 4999.0}) {
    const glm::dquat q = history.at(ours(t))->T_world_vehicle.orientation;
    const double angle = rate_radps * t * 1e-3;
    EXPECT_NEAR(std::abs(q.w * std::cos(angle / 2) + q.z * std::sin(angle / 2)), 1.0, 1e-14) << t;
  }
}

TEST(PoseHistory, FollowsTheTwistAlongAHelix) {
  PoseHistory history{config()};
  PoseSample sample = at_x(0, 0);
  sample.twist = pose::Velocity{{2.0, 0, -0.5}, {0, 0, 0.9}};
  insert(history, sample);
  for (const double t : {0.5, 50.0, 200.0}) {
    const auto estimate = history.at(ours(t));
    ASSERT_TRUE(estimate);
    EXPECT_EQ(estimate->quality, PoseQuality::extrapolated);
    EXPECT_EQ(estimate->age, ours(t) - ours(0));
    const double s = t * 1e-3;
    const glm::dvec3 p = estimate->T_world_vehicle.position_m;
    EXPECT_NEAR(p.x, 2.0 / 0.9 * std::sin(0.9 * s), 1e-12);
    EXPECT_NEAR(p.y, 2.0 / 0.9 * (1 - std::cos(0.9 * s)), 1e-12);
    EXPECT_NEAR(p.z, -0.5 * s, 1e-12);
    EXPECT_NEAR(estimate->T_world_vehicle.orientation.z, std::sin(0.45 * s), 1e-12);
  }
}

TEST(PoseHistory, HoldsWithoutATwist) {
  PoseHistory history{config()};
  insert(history, at_x(0, 1));
  insert(history, at_x(100, 2));
  EXPECT_EQ(x_at(history, 250), 2.0);
  EXPECT_EQ(quality_at(history, 250), PoseQuality::held);
}

TEST(PoseHistory, PolicyHoldStopsAtTheLimit) {
  PoseHistory history{config()};
  PoseSample sample = at_x(0, 0);
  sample.twist = pose::Velocity{{1, 0, 0}, {}};
  insert(history, sample);
  EXPECT_NEAR(x_at(history, 200), 0.2, 1e-12);
  EXPECT_EQ(quality_at(history, 200), PoseQuality::extrapolated);
  EXPECT_NEAR(x_at(history, 60'000), 0.2, 1e-12);
  EXPECT_EQ(quality_at(history, 60'000), PoseQuality::stale);
}

TEST(PoseHistory, PolicySilenceHasNoPoseAfterTheLimitUntilTheNext) {
  PoseHistory history{config(StalePolicy::silence)};
  insert(history, at_x(0, 1));
  EXPECT_TRUE(history.at(ours(200)));
  EXPECT_FALSE(history.stale_at(ours(200)));
  EXPECT_FALSE(history.at(ours(200.001)));
  const auto stale = history.stale_at(ours(2040));
  ASSERT_TRUE(stale);
  EXPECT_EQ(stale_text(*stale),
            "the pose is stale: the newest one is 2.0 s old, and poses.extrapolation_limit_ms allows 200 ms");
  insert(history, at_x(5000, 2));
  EXPECT_EQ(x_at(history, 5001), 2.0);
}

TEST(PoseHistory, BeforeTheOldestThereIsTheOldest) {
  PoseHistory history{config()};
  insert(history, at_x(100, 5));
  EXPECT_EQ(x_at(history, 40), 5.0);
  EXPECT_EQ(quality_at(history, 40), PoseQuality::held);
}

TEST(PoseHistory, StampsMayBeOnAnyClock) {
  for (const std::int64_t epoch_ns : {std::int64_t{0}, std::int64_t{1'760'000'000'000'000'000},
                                      pose::max_time_ns - 1'000'000'000, -pose::max_time_ns}) {
    PoseHistory history{config()};
    // Our clock is past 2^31 ms, as after a month of uptime.
    const nanoseconds arrival = milliseconds{(std::int64_t{1} << 31) + 5};
    for (int i = 0; i < 10; ++i) {
      PoseSample sample = at_x(0, i);
      sample.time_ns = epoch_ns + 10 * i * ms_ns;
      history.insert(sample, arrival + milliseconds{10 * i});
    }
    EXPECT_NEAR(history.at(arrival + milliseconds{45})->T_world_vehicle.position_m.x, 4.5, 1e-9) << epoch_ns;
  }
}

TEST(PoseHistory, JitterOfTheNetworkDoesNotMoveThePose) {
  // 1 m/s, one message per 10 ms. Every second message is 8 ms late, which looks like a jerk of the vehicle.
  PoseHistory history{config()};
  for (int i = 0; i <= 100; ++i) {
    history.insert(at_x(10 * i, 0.01 * i), ours(10 * i) + milliseconds{i % 2 == 0 ? 0 : 8});
  }
  for (double t = 900; t <= 1000; t += 1) {
    EXPECT_NEAR(x_at(history, t), t * 1e-3, 1e-9);
  }
}

TEST(PoseHistory, LateAndRepeatedSamplesFindTheirPlace) {
  PoseHistory history{config()};
  insert(history, at_x(0, 0));
  insert(history, at_x(40, 0.4));
  history.insert(at_x(20, 0.3), ours(41));  // arrives late
  EXPECT_NEAR(x_at(history, 10), 0.15, 1e-12);
  EXPECT_NEAR(x_at(history, 30), 0.35, 1e-12);
  history.insert(at_x(20, 0.1), ours(42));  // repeated with another position
  EXPECT_NEAR(x_at(history, 10), 0.05, 1e-12);
  EXPECT_EQ(history.counters().samples, 4U);
  EXPECT_EQ(history.counters().late, 1U);
  EXPECT_EQ(history.counters().repeated, 1U);
  EXPECT_EQ(history.counters().clock_restarts, 0U);
}

TEST(PoseHistory, AClockSetBackStartsAfresh) {
  PoseHistory history{config()};
  for (int i = 0; i < 10; ++i) {
    insert(history, at_x(60'000 + 10 * i, 100));
  }
  // The simulation is reset 30 ms later.
  const TimePoint reset = ours(60'120);
  history.insert(at_x(0, 1), reset);
  EXPECT_EQ(history.counters().clock_restarts, 1U);
  const auto estimate = history.at(reset);
  ASSERT_TRUE(estimate);
  EXPECT_EQ(estimate->T_world_vehicle.position_m.x, 1.0);
  EXPECT_EQ(estimate->age.count(), 0);
  history.insert(at_x(10, 2), reset + milliseconds{10});
  EXPECT_NEAR(history.at(reset + milliseconds{5})->T_world_vehicle.position_m.x, 1.5, 1e-12);
}

TEST(PoseHistory, AClockSetForwardIsFollowedAtOnce) {
  PoseHistory history{config()};
  insert(history, at_x(0, 1));
  history.insert(at_x(3'600'000, 2), ours(10));
  const auto estimate = history.at(ours(10));
  ASSERT_TRUE(estimate);
  EXPECT_EQ(estimate->T_world_vehicle.position_m.x, 2.0);
  EXPECT_EQ(estimate->age.count(), 0);
}

TEST(PoseHistory, APausedPublisherThatRepeatsItselfIsNotStale) {
  PoseHistory history{config(StalePolicy::silence)};
  for (int i = 0; i < 1000; ++i) {
    history.insert(at_x(0, 1), ours(10 * i));
    ASSERT_TRUE(history.at(ours(10 * i + 9))) << i;
  }
}

TEST(PoseHistory, ASlowSimulationIsNotStale) {
  PoseHistory history{config(StalePolicy::silence)};
  for (int i = 0; i < 1000; ++i) {  // a fifth of real time
    history.insert(at_x(2 * i, 1), ours(10 * i));
    ASSERT_TRUE(history.at(ours(10 * i + 9))) << i;
  }
}

TEST(PoseHistory, ATeleportHasNoWayBetween) {
  PoseHistory history{config()};
  insert(history, at_x(0, 0));
  insert(history, at_x(10, 500));
  EXPECT_EQ(x_at(history, 9.9), 0.0);
  EXPECT_EQ(x_at(history, 10), 500.0);
}

TEST(PoseHistory, FastIsNoTeleport) {
  PoseHistory history{config()};
  insert(history, at_x(0, 0));
  insert(history, at_x(10, 0.9));  // 90 m/s
  EXPECT_NEAR(x_at(history, 5), 0.45, 1e-12);
}

TEST(PoseHistory, BodiesMoveOnTheSameClock) {
  PoseHistory history{config(StalePolicy::silence)};
  for (int i = 0; i < 3; ++i) {
    PoseSample sample = at_x(10 * i, 0);
    sample.bodies = {{"crane", {{0, 0, 1.0 * i}, {}}}};
    if (i == 0) {
      sample.bodies.push_back({"buoy", {{5, 0, 0}, {}}});
    }
    insert(history, sample);
  }
  const auto name = [](const char* expected) { return Field(&PosedBody::name, expected); };
  const auto bodies = history.bodies_at(ours(15));
  ASSERT_THAT(bodies, ElementsAre(name("buoy"), name("crane")));
  EXPECT_EQ(bodies[0].T_world_body.position_m, glm::dvec3(5, 0, 0)) << "said once, stays";
  EXPECT_NEAR(bodies[1].T_world_body.position_m.z, 1.5, 1e-12);
  EXPECT_EQ(history.bodies_at(ours(1e6))[1].T_world_body.position_m.z, 2.0) << "bodies never get stale";
}

constexpr std::int64_t body_period_ms = 500;
constexpr int ping_period_ms = 100;

/// Inserts a pose of a body at 2 Hz, and calls `check` for pings at 10 Hz, each before the next pose arrives.
/// @param at pose of the body at a time in seconds
template <typename At, typename Check>
void follow_body(PoseHistory& history, const At& at, const pose::Velocity& twist, const Check& check) {
  for (std::int64_t i = 0; i < 8; ++i) {
    PoseSample sample = at_x(i * body_period_ms, 0);
    const double time_s = 1e-3 * static_cast<double>(i * body_period_ms);
    sample.bodies = {{"rov", at(time_s), twist}};
    insert(history, sample);
    for (int past_ms = 0; past_ms < body_period_ms; past_ms += ping_period_ms) {
      const double ping_ms = 1e3 * time_s + past_ms;
      const auto bodies = history.bodies_at(ours(ping_ms));
      ASSERT_EQ(bodies.size(), 1U);
      check(bodies[0].T_world_body, at(1e-3 * ping_ms));
    }
  }
}

PoseConfig half_a_second() {
  PoseConfig result = config();
  result.extrapolation_limit = milliseconds{500};
  return result;
}

// 3 m/s. Without the twist, the body would be up to 1.2 m behind.
TEST(PoseHistory, ABodyWithATwistIsOnItsLineAtEachPing) {
  PoseHistory history{half_a_second()};
  const pose::Quat heading = yaw(0.5);
  const auto at = [&](double time_s) {
    return pose::Transform{pose::rotate(heading, {3 * time_s, 0, 0}), heading};
  };
  follow_body(history, at, {{3, 0, 0}, {}}, [](const render::Pose& pose, const pose::Transform& truth) {
    EXPECT_NEAR(pose.position_m.x, truth.position_m.x, 1e-6);
    EXPECT_NEAR(pose.position_m.y, truth.position_m.y, 1e-6);
  });
}

// 10 m radius, 2 m/s: twist and pose are exact, so the helix is the circle.
TEST(PoseHistory, ABodyWithATwistIsOnItsCircleAtEachPing) {
  PoseHistory history{half_a_second()};
  const auto at = [](double time_s) {
    const double angle_rad = 0.2 * time_s;
    return pose::Transform{{10 * std::sin(angle_rad), 10 - 10 * std::cos(angle_rad), -3}, yaw(angle_rad)};
  };
  follow_body(history, at, {{2, 0, 0}, {0, 0, 0.2}},
              [](const render::Pose& pose, const pose::Transform& truth) {
                EXPECT_NEAR(pose.position_m.x, truth.position_m.x, 1e-6);
                EXPECT_NEAR(pose.position_m.y, truth.position_m.y, 1e-6);
                EXPECT_NEAR(pose.position_m.z, -3.0, 1e-12);
                EXPECT_NEAR(pose.orientation.z, truth.orientation.z, 1e-9);
              });
}

// As for the vehicle: between two poses on a straight line, so a circle is cut by its sagitta, 10 (1 - cos
// 0.05) m.
TEST(PoseHistory, InSimulatedTimeABodyIsBetweenItsPoses) {
  PoseConfig simulated = half_a_second();
  simulated.clock = PingClock::simulated;
  PoseHistory history{simulated};
  const auto at = [](double time_s) {
    const double angle_rad = 0.2 * time_s;
    return pose::Transform{{10 * std::sin(angle_rad), 10 - 10 * std::cos(angle_rad), -3}, yaw(angle_rad)};
  };
  for (int i = 0; i < 8; ++i) {
    PoseSample sample = at_x(i * body_period_ms, 0);
    sample.bodies = {{"rov", at(0.5 * i), pose::Velocity{{2, 0, 0}, {0, 0, 0.2}}}};
    insert(history, sample);
  }
  for (int ping_ms = 0; ping_ms < 3500; ping_ms += ping_period_ms) {
    const auto bodies = history.bodies_at(TimePoint{ping_ms * ms_ns});
    const pose::Vec3 truth = at(1e-3 * ping_ms).position_m;
    EXPECT_LT(std::hypot(bodies[0].T_world_body.position_m.x - truth.x,
                         bodies[0].T_world_body.position_m.y - truth.y),
              10 * (1 - std::cos(0.05)) + 1e-9);
  }
}

TEST(PoseHistory, ABodyFollowsItsTwistUpToTheLimit) {
  PoseHistory history{config()};  // 200 ms
  PoseSample sample = at_x(0, 0);
  sample.bodies = {{"rov", {}, pose::Velocity{{1, 0, 0}, {}}}};
  insert(history, sample);
  EXPECT_NEAR(history.bodies_at(ours(150))[0].T_world_body.position_m.x, 0.15, 1e-9);
  EXPECT_NEAR(history.bodies_at(ours(1e6))[0].T_world_body.position_m.x, 0.2, 1e-9);
  sample = at_x(400, 0);
  sample.bodies = {{"rov", {{5, 0, 0}, {}}}};
  insert(history, sample);
  EXPECT_EQ(history.bodies_at(ours(500))[0].T_world_body.position_m.x, 5.0) << "this pose has no twist";
}

TEST(PoseHistory, PublishersCannotInventBodiesForEver) {
  PoseHistory history{config()};
  for (int i = 0; i < 2000; ++i) {
    PoseSample sample = at_x(i, 0);
    sample.bodies = {{"body " + std::to_string(i), {}}};
    insert(history, sample);
  }
  EXPECT_EQ(history.bodies_at(ours(2000)).size(), PoseHistory::max_bodies);
  EXPECT_EQ(history.counters().bodies_ignored, 2000 - PoseHistory::max_bodies);
}

TEST(PoseTrack, KeepsTheNewestPoints) {
  PoseTrack track{4};
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(track.insert({10 * i, {}, {}}), PoseTrack::Placed::newest);
    EXPECT_LE(track.size(), 4U);
  }
  EXPECT_EQ(track.oldest().time_ns, 960);
  EXPECT_EQ(track.insert({950, {}, {}}), PoseTrack::Placed::too_old);
  EXPECT_EQ(track.insert({965, {}, {}}), PoseTrack::Placed::between);
  EXPECT_EQ(track.insert({990, {}, {}}), PoseTrack::Placed::replaced);
  EXPECT_EQ(track.size(), 4U);
  EXPECT_EQ(track.oldest().time_ns, 965);
  EXPECT_EQ(track.newest().time_ns, 990);
}

glm::dvec3 speed_at(const PoseHistory& history, double time_ms) {
  const pose::Vec3 v = history.twist_at(ours(time_ms)).linear_mps;
  return {v.x, v.y, v.z};
}

TEST(PoseHistory, TwistIsThatOfThePosesWhereTheyHaveOne) {
  PoseHistory history{config()};
  EXPECT_EQ(speed_at(history, 0), glm::dvec3(0));
  for (const int k : {0, 1}) {
    PoseSample sample = at_x(100 * k, 0);
    sample.twist = pose::Velocity{{1.0 + k, 0, 2}, {0, 0, 3}};
    insert(history, sample);
  }
  EXPECT_NEAR(speed_at(history, 25).x, 1.25, 1e-6);
  EXPECT_EQ(speed_at(history, 300), glm::dvec3(2, 0, 2)) << "past the newest pose";
  EXPECT_EQ(history.twist_at(ours(300)).angular_radps.z, 3.0);
  EXPECT_EQ(speed_at(history, 301), glm::dvec3(0)) << "past the extrapolation limit";
}

// 2 m/s to the east while the vehicle turns to port by 1 rad/s.
TEST(PoseHistory, TwistIsTheMotionBetweenPosesWithoutOneInTheFrameOfTheVehicle) {
  PoseHistory history{config()};
  for (const int k : {0, 1, 2}) {
    PoseSample sample = at_x(100 * k, 0.2 * k);
    sample.T_world_vehicle.orientation = yaw(0.1 * k);
    insert(history, sample);
  }
  const glm::dvec3 between = speed_at(history, 150);
  EXPECT_NEAR(between.x, 2 * std::cos(0.15), 1e-6);
  EXPECT_NEAR(between.y, -2 * std::sin(0.15), 1e-6);
  EXPECT_NEAR(history.twist_at(ours(150)).angular_radps.z, 1.0, 1e-9);
  const glm::dvec3 after = speed_at(history, 250);
  EXPECT_NEAR(after.x, 2 * std::cos(0.2), 1e-6);
  EXPECT_NEAR(after.y, -2 * std::sin(0.2), 1e-6);
}

TEST(PoseHistory, TwistIsZeroWhereAVehicleWasMovedAndAfterAPause) {
  PoseHistory history{config()};
  insert(history, at_x(0, 0));
  insert(history, at_x(100, 50));
  EXPECT_EQ(speed_at(history, 50), glm::dvec3(0));
  EXPECT_EQ(speed_at(history, 100), glm::dvec3(0));
  insert(history, at_x(1000, 51));
  EXPECT_EQ(speed_at(history, 1000), glm::dvec3(0));
}

}  // namespace
}  // namespace sonard::server
