// SPDX-License-Identifier: Apache-2.0
// Trajectory files: parsing, playback, and the line number in each error.
#include "protocol/pose/trajectory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "tests/support/temporary_folder.hpp"
#include "tests/support/without_rights.hpp"
#include "tests/unit/protocol/pose/pose_matchers.hpp"

namespace sonard::pose {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double pi = std::numbers::pi;
constexpr std::int64_t second_ns = 1'000'000'000;

Trajectory parse(std::string_view text, Axes axes = Axes::enu_flu) {
  return parse_trajectory(text, "t.csv", axes);
}

TEST(TrajectoryFile, ReadsCsv) {
  const Trajectory trajectory = parse(
      "t,x,y,z,qx,qy,qz,qw\n"
      "0.5,1,2,3,0,0,0,1\n"
      "1.25, -1e1 ,2,3, 0,0,0.6,0.8\n");
  ASSERT_EQ(trajectory.points().size(), 2U);
  EXPECT_EQ(trajectory.start_ns(), 500'000'000);
  EXPECT_EQ(trajectory.end_ns(), 1'250'000'000);
  EXPECT_THAT(trajectory.points()[1].T_world_vehicle.position_m, IsVec3(Vec3{-10, 2, 3}, 0));
  EXPECT_THAT(trajectory.points()[1].T_world_vehicle.orientation, IsRotation(Quat{0.8, 0, 0, 0.6}, 1e-15));
}

TEST(TrajectoryFile, ReadsTum) {
  const Trajectory trajectory = parse(
      "# timestamp tx ty tz qx qy qz qw\n"
      "1305031102.1753 1.0 2.0 3.0 0 0 0 1\n"
      "1305031102.2116\t1.5  2.5 3.5 0 0 0 1\n");
  ASSERT_EQ(trajectory.points().size(), 2U);
  // A double holds such a time with a resolution of 0.24 us.
  EXPECT_NEAR(static_cast<double>(trajectory.start_ns() - 1'305'031'102'175'300'000), 0.0, 500.0);
  EXPECT_THAT(trajectory.points()[1].T_world_vehicle.position_m, IsVec3(Vec3{1.5, 2.5, 3.5}, 0));
}

TEST(TrajectoryFile, ForgivesCommentsBlankLinesAndWindows) {
  const Trajectory trajectory = parse(
      "\xEF\xBB\xBF# made by hand\r\n"
      "\r\n"
      "t,x,y,z,qx,qy,qz,qw\r\n"
      "  # in between\r\n"
      "0,0,0,0,0,0,0,1\r\n"
      "1,0,0,0,0,0,0,1");
  EXPECT_EQ(trajectory.points().size(), 2U);
}

TEST(TrajectoryFile, NedIsConverted) {
  const Trajectory trajectory = parse("0 10 20 30 0 0 0 1\n", Axes::ned_frd);
  EXPECT_THAT(trajectory.points()[0].T_world_vehicle.position_m, IsVec3(Vec3{20, 10, -30}, 0));
  EXPECT_THAT(trajectory.points()[0].T_world_vehicle.orientation, IsRotation(yaw(pi / 2), 1e-15));
}

struct BadFile {
  const char* name;
  std::string text;
  const char* message;
};

void PrintTo(const BadFile& bad, std::ostream* out) {
  *out << bad.name;
}

class BadFiles : public testing::TestWithParam<BadFile> {};

TEST_P(BadFiles, AreReportedWithTheirLine) {
  try {
    parse(GetParam().text);
    FAIL() << "no error";
  } catch (const TrajectoryError& error) {
    EXPECT_STREQ(error.what(), GetParam().message);
  }
}

const std::string header = "t,x,y,z,qx,qy,qz,qw\n";

INSTANTIATE_TEST_SUITE_P(
    All, BadFiles,
    testing::Values(
        BadFile{"empty", "", "t.csv:1: the trajectory has no points"},
        BadFile{"only_comments", "# a\n# b\n", "t.csv:2: the trajectory has no points"},
        BadFile{"only_header", header, "t.csv:1: the trajectory has no points"},
        BadFile{"wrong_header", "t,x,y,z,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n",
                "t.csv:1: expected the header t,x,y,z,qx,qy,qz,qw"},
        BadFile{"no_header", "0,0,0,0,0,0,0,1\n", "t.csv:1: expected the header t,x,y,z,qx,qy,qz,qw"},
        BadFile{"long_header", "t,x,y,z,qx,qy,qz,qw,v\n", "t.csv:1: expected the header t,x,y,z,qx,qy,qz,qw"},
        BadFile{"too_few", header + "0,0,0,0,0,0,1\n",
                "t.csv:2: expected 8 columns (t,x,y,z,qx,qy,qz,qw), found 7"},
        BadFile{"too_many", header + "0,0,0,0,0,0,0,1,\n",
                "t.csv:2: expected 8 columns (t,x,y,z,qx,qy,qz,qw), found 9"},
        BadFile{"tum_too_few", "0 0 0 0 0 0 0 1\n1 0 0 0\n",
                "t.csv:2: expected 8 columns (t,x,y,z,qx,qy,qz,qw), found 4"},
        BadFile{"not_a_number", header + "0,0,zero,0,0,0,0,1\n", "t.csv:2: y 'zero' is not a number"},
        BadFile{"number_with_rest", header + "0,0,1.5m,0,0,0,0,1\n", "t.csv:2: y '1.5m' is not a number"},
        BadFile{"decimal_comma", "0 0,5 0 0 0 0 0 1\n", "t.csv:1: expected the header t,x,y,z,qx,qy,qz,qw"},
        BadFile{"empty_field", header + "0,0,,0,0,0,0,1\n", "t.csv:2: y '' is not a number"},
        BadFile{"nan", header + "0,0,0,0,0,0,0,1\n\n1,nan,0,0,0,0,0,1\n", "t.csv:4: x is not finite"},
        BadFile{"infinite_quaternion", header + "0,0,0,0,0,-inf,0,1\n", "t.csv:2: qy is not finite"},
        BadFile{"out_of_range", header + "0,1e999,0,0,0,0,0,1\n", "t.csv:2: x '1e999' is out of range"},
        BadFile{"far", header + "0,1e9,0,0,0,0,0,1\n", "t.csv:2: position is beyond 1e8 m"},
        BadFile{"zero_quaternion", header + "0,0,0,0,0,0,0,0\n",
                "t.csv:2: orientation has a norm outside 0.001..1000, so it is not a rotation"},
        BadFile{"time_stands", header + "1,0,0,0,0,0,0,1\n# x\n1.0,0,0,0,0,0,0,1\n",
                "t.csv:4: t '1.0' is not after the time of line 2"},
        BadFile{"time_falls", "2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n",
                "t.csv:2: t '1' is not after the time of line 1"},
        BadFile{"time_in_ns", header + "1700000000000000000,0,0,0,0,0,0,1\n",
                "t.csv:2: t '1700000000000000000' is beyond 4e9 s; time is in seconds"}),
    [](const auto& tested) { return tested.param.name; });

TEST(TrajectoryFile, ThatMayNotBeReadIsToldWithTheReason) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "motion.csv";
  std::ofstream(file) << "t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n";
  std::filesystem::permissions(file, std::filesystem::perms::none);
  std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
  const test::WithoutRights nobody;
  try {
    load_trajectory(file);
    FAIL() << "it was read";
  } catch (const TrajectoryError& error) {
    EXPECT_EQ(error.what(), file.string() + ": cannot be read: Permission denied");
  }
}

std::string complaint_about(const std::filesystem::path& file) {
  try {
    load_trajectory(file);
  } catch (const TrajectoryError& error) {
    return error.what();
  }
  return "";
}

TEST(TrajectoryFile, InAFolderWithoutRightsIsToldWithTheReason) {
  const test::TemporaryFolder folder;
  const auto closed = folder.path() / "closed";
  std::filesystem::create_directory(closed);
  std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
  std::filesystem::permissions(closed, std::filesystem::perms::none);
  const test::WithoutRights nobody;
  EXPECT_EQ(complaint_about(closed / "motion.csv"),
            (closed / "motion.csv").string() + ": cannot be read: Permission denied");
}

TEST(TrajectoryFile, ALoopOfLinksIsToldWithTheReason) {
  const test::TemporaryFolder folder;
  const auto loop = folder.path() / "loop";
  std::filesystem::create_symlink(loop, loop);
  EXPECT_EQ(complaint_about(loop), loop.string() + ": cannot be read: Too many levels of symbolic links");
}

TEST(TrajectoryFile, AMissingFileIsNamed) {
  EXPECT_THROW(
      {
        try {
          load_trajectory("/nowhere/motion.csv");
        } catch (const TrajectoryError& error) {
          EXPECT_STREQ(error.what(), "/nowhere/motion.csv: cannot be read: No such file or directory");
          throw;
        }
      },
      TrajectoryError);
  EXPECT_THROW(load_trajectory("/"), TrajectoryError);
}

/// One second east at 2 m/s while turning left by 1 rad, then one second at rest.
Trajectory turning_then_resting() {
  return Trajectory{{{5 * second_ns, {{0, 0, 0}, yaw(0.0)}},
                     {6 * second_ns, {{2, 0, 0}, yaw(1.0)}},
                     {7 * second_ns, {{2, 0, 0}, yaw(1.0)}}}};
}

TEST(TrajectoryState, GoesBetweenPoints) {
  const TrajectoryState state = turning_then_resting().at(5 * second_ns + second_ns / 4);
  EXPECT_THAT(state.T_world_vehicle.position_m, IsVec3(Vec3{0.5, 0, 0}, 1e-15));
  EXPECT_THAT(state.T_world_vehicle.orientation, IsRotation(yaw(0.25), 1e-15));
  // The vehicle moves east at 2 m/s and heads 0.25 rad to the left of east, so it moves partly to starboard.
  EXPECT_THAT(state.twist.linear_mps, IsVec3(Vec3{2 * std::cos(0.25), -2 * std::sin(0.25), 0}, 1e-14));
  EXPECT_THAT(state.twist.angular_radps, IsVec3(Vec3{0, 0, 1}, 1e-14));
}

TEST(TrajectoryState, TwistIsTheDerivativeOfThePose) {
  const Trajectory trajectory = turning_then_resting();
  const std::int64_t time_ns = 5'600'000'000;
  const std::int64_t step_ns = 1'000'000;
  const TrajectoryState now = trajectory.at(time_ns);
  const TrajectoryState soon = trajectory.at(time_ns + step_ns);
  const Transform carried_on = advance(now.T_world_vehicle, now.twist, 1e-9 * static_cast<double>(step_ns));
  EXPECT_THAT(carried_on.position_m, IsVec3(soon.T_world_vehicle.position_m, 2e-6))
      << "second order in the step";
  EXPECT_THAT(carried_on.orientation, IsRotation(soon.T_world_vehicle.orientation, 1e-12));
}

TEST(TrajectoryState, RestsOutside) {
  const Trajectory trajectory = turning_then_resting();
  for (const std::int64_t time_ns : {std::int64_t{0}, 7 * second_ns, 100 * second_ns}) {
    const TrajectoryState state = trajectory.at(time_ns);
    EXPECT_THAT(state.T_world_vehicle.position_m, IsVec3(Vec3{time_ns == 0 ? 0.0 : 2.0, 0, 0}, 0));
    EXPECT_THAT(state.twist.linear_mps, IsVec3(Vec3{}, 0));
    EXPECT_THAT(state.twist.angular_radps, IsVec3(Vec3{}, 0));
  }
}

TEST(TrajectoryPlayback, SpeedScalesTimeAndTwist) {
  const PoseSample sample = play(turning_then_resting(), {2.0, false, 0}, milliseconds{125});
  EXPECT_THAT(sample.T_world_vehicle.position_m, IsVec3(Vec3{0.5, 0, 0}, 1e-14));
  ASSERT_TRUE(sample.twist);
  EXPECT_NEAR(norm(sample.twist->linear_mps), 4.0, 1e-13);
  EXPECT_NEAR(norm(sample.twist->angular_radps), 2.0, 1e-13);
}

TEST(TrajectoryPlayback, StartsWhereItIsTold) {
  const PoseSample sample = play(turning_then_resting(), {1.0, false, second_ns / 2}, milliseconds{250});
  EXPECT_THAT(sample.T_world_vehicle.position_m, IsVec3(Vec3{1.5, 0, 0}, 1e-14));
}

TEST(TrajectoryPlayback, EndsAtRestAtTheLastPoint) {
  const Trajectory trajectory{{{0, {{0, 0, 0}, {}}}, {second_ns, {{1, 0, 0}, {}}}}};
  const Playback once{1.0, false, 0};
  EXPECT_FALSE(finished(trajectory, once, milliseconds{999}));
  EXPECT_TRUE(finished(trajectory, once, seconds{1}));
  const PoseSample last = play(trajectory, once, seconds{5});
  EXPECT_THAT(last.T_world_vehicle.position_m, IsVec3(Vec3{1, 0, 0}, 0));
  ASSERT_TRUE(last.twist);
  EXPECT_THAT(last.twist->linear_mps, IsVec3(Vec3{}, 0));
}

TEST(TrajectoryPlayback, LoopsForEver) {
  const Trajectory trajectory = turning_then_resting();  // two seconds long
  const Playback loop{1.0, true, 0};
  EXPECT_FALSE(finished(trajectory, loop, seconds{1'000'000}));
  const PoseSample sample = play(trajectory, loop, seconds{200} + milliseconds{500});
  EXPECT_THAT(sample.T_world_vehicle.position_m, IsVec3(Vec3{1, 0, 0}, 1e-12));
}

TEST(TrajectoryPlayback, OnePointRests) {
  const Trajectory trajectory{{{second_ns, {{1, 2, 3}, {}}}}};
  EXPECT_THAT(play(trajectory, {1.0, true, 0}, seconds{3}).T_world_vehicle.position_m,
              IsVec3(Vec3{1, 2, 3}, 0));
  EXPECT_TRUE(finished(trajectory, {1.0, false, 0}, seconds{0}));
}

TEST(TrajectoryPlayback, AJumpHasNoTwist) {
  const Trajectory trajectory{{{0, {{0, 0, 0}, {}}}, {2, {{1000, 0, 0}, {}}}}};
  EXPECT_FALSE(play(trajectory, {}, std::chrono::nanoseconds{1}).twist);
}

}  // namespace
}  // namespace sonard::pose
