// SPDX-License-Identifier: Apache-2.0
// Rigid motion against closed-form solutions.
#include "protocol/pose/transform.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/unit/protocol/pose/pose_matchers.hpp"

namespace sonard::pose {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(Transform, QuarterTurnAboutUpTakesForwardToPort) {
  EXPECT_THAT(rotate(yaw(pi / 2), {1, 0, 0}), IsVec3(Vec3{0, 1, 0}, 1e-15));
  EXPECT_THAT(rotate(yaw(pi / 2), {0, 1, 0}), IsVec3(Vec3{-1, 0, 0}, 1e-15));
  EXPECT_THAT(rotate(yaw(pi / 2), {0, 0, 1}), IsVec3(Vec3{0, 0, 1}, 1e-15));
}

TEST(Transform, PositivePitchPointsTheNoseDown) {
  const double pitch = 0.3;
  const Quat q = from_rotation_vector({0, pitch, 0});
  EXPECT_THAT(rotate(q, {1, 0, 0}), IsVec3(Vec3{std::cos(pitch), 0, -std::sin(pitch)}, 1e-15));
}

TEST(Transform, ProductRotatesByTheRightFactorFirst) {
  const Quat turn_then_roll = from_rotation_vector({pi / 2, 0, 0}) * yaw(pi / 2);
  // The yaw maps x to y, then the roll maps y to z.
  EXPECT_THAT(rotate(turn_then_roll, {1, 0, 0}), IsVec3(Vec3{0, 0, 1}, 1e-15));
}

TEST(Transform, RotationVectorSurvivesTheWayThere) {
  for (const double angle : {1e-13, 1e-9, 1e-5, 0.99e-4, 1.01e-4, 0.5, 3.0, pi - 1e-9}) {
    const Vec3 v = angle * Vec3{2.0 / 7, -3.0 / 7, 6.0 / 7};
    EXPECT_THAT(to_rotation_vector(from_rotation_vector(v)), IsVec3(v, 1e-15 + 1e-12 * angle)) << angle;
  }
}

TEST(Transform, RotationVectorTakesTheShortWay) {
  // 350 degrees to the left are 10 degrees to the right; q and -q are one rotation.
  const Quat q = yaw(350.0 / 180.0 * pi);
  EXPECT_THAT(to_rotation_vector(q), IsVec3(Vec3{0, 0, -10.0 / 180.0 * pi}, 1e-14));
  EXPECT_THAT(to_rotation_vector({-q.w, -q.x, -q.y, -q.z}), IsVec3(Vec3{0, 0, -10.0 / 180.0 * pi}, 1e-14));
}

TEST(Transform, InterpolatesOnTheLineAndTheArc) {
  const Transform from{{0, 10, -2}, yaw(0.2)};
  const Transform to{{4, 10, 2}, yaw(1.0)};
  const Transform quarter = interpolate(from, to, 0.25);
  EXPECT_THAT(quarter.position_m, IsVec3(Vec3{1, 10, -1}, 1e-15));
  EXPECT_THAT(quarter.orientation, IsRotation(yaw(0.4), 1e-15));
}

TEST(Transform, InterpolationIsTheSameForEitherSignOfAQuaternion) {
  const Quat q = yaw(1.0);
  const Transform from{{}, yaw(0.2)};
  EXPECT_THAT(interpolate(from, {{}, {-q.w, -q.x, -q.y, -q.z}}, 0.25).orientation,
              IsRotation(yaw(0.4), 1e-15));
  EXPECT_THAT(interpolate({{}, {-q.w, -q.x, -q.y, -q.z}}, from, 0.75).orientation,
              IsRotation(yaw(0.4), 1e-15));
}

TEST(Transform, InterpolatesAcrossTheBackwardHeading) {
  const Transform from{{}, yaw(pi - 0.1)};
  const Transform to{{}, yaw(-pi + 0.1)};
  EXPECT_THAT(interpolate(from, to, 0.5).orientation, IsRotation(yaw(pi), 1e-14));
}

TEST(Transform, ConstantTwistMakesAHelix) {
  const double turn_radps = 0.7;
  const Velocity twist{{2.0, 0.0, -0.3}, {0.0, 0.0, turn_radps}};
  for (const double t : {0.0, 1e-7, 1e-3, 0.5, 2.0, 20.0, -3.0}) {
    const Transform moved = advance({}, twist, t);
    const double radius = 2.0 / turn_radps;
    const Vec3 expected{radius * std::sin(turn_radps * t), radius * (1 - std::cos(turn_radps * t)), -0.3 * t};
    EXPECT_THAT(moved.position_m, IsVec3(expected, 1e-13)) << t;
    EXPECT_THAT(moved.orientation, IsRotation(yaw(turn_radps * t), 1e-13)) << t;
  }
}

TEST(Transform, TwistIsInTheAxesOfTheBody) {
  // Heading along world y and moving forward is motion along world y.
  const Transform moved = advance({{5, 5, 5}, yaw(pi / 2)}, {{2, 0, 0}, {}}, 3.0);
  EXPECT_THAT(moved.position_m, IsVec3(Vec3{5, 11, 5}, 1e-14));
}

TEST(Transform, AdvanceAgreesWithSmallStepsAboutASkewAxis) {
  const Transform start{{1, 2, 3}, from_rotation_vector({0.3, -0.4, 1.2})};
  const Velocity twist{{0.5, -0.2, 0.1}, {0.6, 0.3, -0.9}};
  // Midpoint rule, with a second-order error in the step, about 1e-9 here.
  Transform stepped = start;
  const int steps = 20'000;
  const double dt = 2.0 / steps;
  for (int i = 0; i < steps; ++i) {
    const Quat middle = stepped.orientation * from_rotation_vector(0.5 * dt * twist.angular_radps);
    stepped.position_m = stepped.position_m + dt * rotate(middle, twist.linear_mps);
    stepped.orientation = stepped.orientation * from_rotation_vector(dt * twist.angular_radps);
  }
  const Transform moved = advance(start, twist, 2.0);
  EXPECT_THAT(moved.position_m, IsVec3(stepped.position_m, 1e-8));
  EXPECT_THAT(moved.orientation, IsRotation(stepped.orientation, 1e-10));
}

TEST(Transform, AdvanceHasNoSeamWhereItsSeriesEnd) {
  // Exact to the fourth power of the turn, which is 1e-12 just below and just above 1e-3 rad.
  const Velocity twist{{1, 2, 3}, {0, 0, 1}};
  for (const double t : {1e-3 * (1 - 1e-9), 1e-3 * (1 + 1e-9)}) {
    const double s = std::sin(t);
    const double c = 1 - std::cos(t);
    EXPECT_THAT(advance({}, twist, t).position_m, IsVec3(Vec3{s - 2 * c, c + 2 * s, 3 * t}, 1e-15)) << t;
  }
}

// Quaternions have norm 1 up to rounding only. To normalise them again may change a last bit.
TEST(Transform, WhatRestsKeepsEveryBit) {
  for (int i = 0; i < 1000; ++i) {
    const double x = 0.001 * i;
    const Transform pose{{1.0 / 3.0 + i, 2.0 / 7.0, -0.1}, normalized({0.9, x, 0.3 - x, 0.7 * x})};
    EXPECT_EQ(interpolate(pose, pose, 0.37), pose);
    EXPECT_EQ(advance(pose, {}, 0.2), pose);
  }
}

TEST(Transform, NedFrdBecomesEnuFlu) {
  // At rest in NED: nose north, starboard east, keel down.
  const Transform level = enu_flu_from_ned_frd({{10, 20, 30}, {}});
  EXPECT_THAT(level.position_m, IsVec3(Vec3{20, 10, -30}, 0));
  EXPECT_THAT(rotate(level.orientation, {1, 0, 0}), IsVec3(Vec3{0, 1, 0}, 1e-15)) << "forward is north";
  EXPECT_THAT(rotate(level.orientation, {0, 1, 0}), IsVec3(Vec3{-1, 0, 0}, 1e-15)) << "port is west";
  EXPECT_THAT(rotate(level.orientation, {0, 0, 1}), IsVec3(Vec3{0, 0, 1}, 1e-15)) << "up is up";
}

TEST(Transform, NedHeadingIsClockwiseFromNorth) {
  // NED yaw of 90 degrees: nose east.
  const Transform east = enu_flu_from_ned_frd({{}, yaw(pi / 2)});
  EXPECT_THAT(rotate(east.orientation, {1, 0, 0}), IsVec3(Vec3{1, 0, 0}, 1e-15));
  EXPECT_THAT(rotate(east.orientation, {0, 1, 0}), IsVec3(Vec3{0, 1, 0}, 1e-15)) << "port is north";
}

TEST(Transform, FrdPitchUpIsNoseUp) {
  // In FRD a positive pitch raises the nose.
  const double pitch = 0.2;
  const Transform up = enu_flu_from_ned_frd({{}, from_rotation_vector({0, pitch, 0})});
  EXPECT_THAT(rotate(up.orientation, {1, 0, 0}), IsVec3(Vec3{0, std::cos(pitch), std::sin(pitch)}, 1e-15));
}

TEST(Transform, FrdTwistBecomesFlu) {
  const Velocity flu = flu_from_frd({{1, 2, 3}, {4, 5, 6}});
  EXPECT_THAT(flu.linear_mps, IsVec3(Vec3{1, -2, -3}, 0));
  EXPECT_THAT(flu.angular_radps, IsVec3(Vec3{4, -5, -6}, 0));
}

TEST(Transform, ConversionCommutesWithMotion) {
  // Motion followed by conversion equals conversion followed by motion.
  const Transform ned{{1, 2, 3}, from_rotation_vector({0.1, 0.2, 0.3})};
  const Velocity frd{{1, 0.5, -0.2}, {0.1, -0.3, 0.4}};
  const Transform one = enu_flu_from_ned_frd(advance(ned, frd, 1.5));
  const Transform other = advance(enu_flu_from_ned_frd(ned), flu_from_frd(frd), 1.5);
  EXPECT_THAT(one.position_m, IsVec3(other.position_m, 1e-14));
  EXPECT_THAT(one.orientation, IsRotation(other.orientation, 1e-14));
}

struct FaultCase {
  Transform transform;
  TransformFault fault;
};

class TransformFaults : public testing::TestWithParam<FaultCase> {};

TEST_P(TransformFaults, AreNamedAndLeaveTheTransformAlone) {
  Transform transform = GetParam().transform;
  EXPECT_EQ(normalize(transform), GetParam().fault);
  EXPECT_EQ(std::isnan(transform.orientation.w), std::isnan(GetParam().transform.orientation.w));
}

INSTANTIATE_TEST_SUITE_P(
    All, TransformFaults,
    testing::Values(FaultCase{{{nan, 0, 0}, {}}, TransformFault::position_not_finite},
                    FaultCase{{{0, infinity, 0}, {}}, TransformFault::position_not_finite},
                    FaultCase{{{0, 0, -infinity}, {}}, TransformFault::position_not_finite},
                    FaultCase{{{0, 0, 1.01e8}, {}}, TransformFault::position_too_large},
                    FaultCase{{{1e300, 0, 0}, {}}, TransformFault::position_too_large},
                    FaultCase{{{}, {nan, 0, 0, 0}}, TransformFault::orientation_not_finite},
                    FaultCase{{{}, {1, 0, 0, nan}}, TransformFault::orientation_not_finite},
                    FaultCase{{{}, {infinity, 0, 0, 0}}, TransformFault::orientation_not_finite},
                    FaultCase{{{}, {0, 0, 0, 0}}, TransformFault::orientation_norm},
                    FaultCase{{{}, {1e-20, 0, 0, 0}}, TransformFault::orientation_norm},
                    FaultCase{{{}, {0, 1e20, 0, 0}}, TransformFault::orientation_norm},
                    FaultCase{{{}, {0, 0, 1e-200, 0}}, TransformFault::orientation_norm},
                    FaultCase{{{}, {0, 0, 0, 1e200}}, TransformFault::orientation_norm}));

TEST(Transform, NonUnitQuaternionIsScaled) {
  for (const double scale : {0.002, 0.5, 1.0 + 1e-7, 2.0, 900.0, -3.0}) {
    const Quat q = yaw(0.8);
    Transform transform{{1e7, -1e7, 1e7}, {scale * q.w, scale * q.x, scale * q.y, scale * q.z}};
    ASSERT_EQ(normalize(transform), TransformFault::none);
    EXPECT_NEAR(norm(transform.orientation), 1.0, 1e-15);
    EXPECT_THAT(transform.orientation, IsRotation(q, 1e-15));
  }
}

}  // namespace
}  // namespace sonard::pose
