// SPDX-License-Identifier: Apache-2.0
// What the bridge makes of messages: frames, stamps, trees. Poses are followed up to the image by
// ros1_test.py.
#include "clients/ros1/pose_bridge.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/unit/pose/pose_matchers.hpp"

namespace sonard::client {
namespace {

using pose::IsVec3;
using pose::Vec3;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t second_ns = 1'000'000'000;
const double half = std::sqrt(0.5);
const pose::Quat level{1, 0, 0, 0};
const pose::Quat to_port{half, 0, 0, half};

class PoseBridgeTest : public testing::Test {
 protected:
  PoseBridge& bridge(BridgeSettings settings) {
    bridge_.emplace(
        std::move(settings), [this](const pose::PoseSample& sample) { sent_.push_back(sample); },
        [this](const std::string& line) { said_.push_back(line); });
    return *bridge_;
  }
  PoseBridge& odometry_bridge(const std::string& world = "world", const std::string& vehicle = "",
                              pose::Axes axes = pose::Axes::enu_flu) {
    return bridge({world, vehicle, true, axes, {}});
  }
  PoseBridge& tree_bridge(std::vector<FollowedFrame> bodies = {}) {
    return bridge({"map", "base_link", false, pose::Axes::enu_flu, std::move(bodies)});
  }
  static RosPose odometry(const std::string& frame = "world") {
    return {frame, "base_link", second_ns, {{1, 2, 3}, to_port}, pose::Velocity{{4, 5, 6}, {7, 8, 9}}};
  }
  static RosPose at(double seconds, const std::string& frame, const std::string& child, const Vec3& position,
                    const pose::Quat& orientation = level) {
    return {frame, child, static_cast<std::int64_t>(seconds * 1e9), {position, orientation}, {}};
  }

  std::optional<PoseBridge> bridge_;
  std::vector<pose::PoseSample> sent_;
  std::vector<std::string> said_;
};

TEST_F(PoseBridgeTest, OdometryIsTakenAsItIs) {
  odometry_bridge().on_odometry(odometry());
  ASSERT_EQ(sent_.size(), 1U);
  EXPECT_EQ(sent_[0].time_ns, second_ns);
  EXPECT_THAT(sent_[0].T_world_vehicle.position_m, IsVec3(Vec3{1, 2, 3}, 0.0));
  EXPECT_THAT(rotate(sent_[0].T_world_vehicle.orientation, {1, 0, 0}), IsVec3(Vec3{0, 1, 0}, 1e-12));
  ASSERT_TRUE(sent_[0].twist);
  EXPECT_THAT(sent_[0].twist->linear_mps, IsVec3(Vec3{4, 5, 6}, 0.0));
  EXPECT_THAT(sent_[0].twist->angular_radps, IsVec3(Vec3{7, 8, 9}, 0.0));
}

TEST_F(PoseBridgeTest, NedIsTurned) {
  odometry_bridge("world_ned", "", pose::Axes::ned_frd).on_odometry(odometry("/world_ned"));
  ASSERT_EQ(sent_.size(), 1U);
  EXPECT_THAT(sent_[0].T_world_vehicle.position_m, IsVec3(Vec3{2, 1, -3}, 0.0));
  // +90 about down, from north: east.
  EXPECT_THAT(rotate(sent_[0].T_world_vehicle.orientation, {1, 0, 0}), IsVec3(Vec3{1, 0, 0}, 1e-12));
  EXPECT_THAT(sent_[0].twist->linear_mps, IsVec3(Vec3{4, -5, -6}, 0.0));
  EXPECT_THAT(sent_[0].twist->angular_radps, IsVec3(Vec3{7, -8, -9}, 0.0));
}

TEST_F(PoseBridgeTest, OtherFramesAreDroppedAndSaidOnce) {
  PoseBridge& bridge = odometry_bridge("world", "base_link");
  bridge.on_odometry(odometry("world_ned"));
  bridge.on_odometry(odometry("world_ned"));
  RosPose other = odometry();
  other.child_frame = "arm";
  bridge.on_odometry(other);
  EXPECT_THAT(sent_, IsEmpty());
  EXPECT_EQ(bridge.counters().wrong_frame, 3U);
  EXPECT_THAT(said_, ElementsAre(HasSubstr("frame_id 'world_ned' is dropped: expected 'world'"),
                                 HasSubstr("child_frame_id 'arm' is dropped: expected 'base_link'")));
}

TEST_F(PoseBridgeTest, MessagesWithoutTimeOrSenseAreDropped) {
  PoseBridge& bridge = odometry_bridge();
  RosPose timeless = odometry();
  timeless.stamp_ns = 0;
  bridge.on_odometry(timeless);
  RosPose no_rotation = odometry();
  no_rotation.T_frame_child.orientation = {0, 0, 0, 0};
  bridge.on_odometry(no_rotation);
  RosPose nan = odometry();
  nan.twist->angular_radps.y = std::numeric_limits<double>::quiet_NaN();
  bridge.on_odometry(nan);
  RosPose fast = odometry();
  fast.twist->linear_mps.x = 1e7;
  bridge.on_odometry(fast);
  EXPECT_THAT(sent_, IsEmpty());
  EXPECT_EQ(bridge.counters().no_stamp, 1U);
  EXPECT_EQ(bridge.counters().bad_value, 3U);
  EXPECT_THAT(said_, ElementsAre(HasSubstr("stamp of 0"), HasSubstr("orientation has a norm"),
                                 HasSubstr("twist is not finite")));
}

TEST_F(PoseBridgeTest, ChainOfTransformsAtItsNewestCommonTime) {
  PoseBridge& bridge = tree_bridge();
  bridge.on_transforms({at(0, "/map", "/site", {100, 0, 0}, to_port)}, true);
  bridge.on_transforms({at(10.0, "site", "odom", {0, 0, 0}), at(10.2, "site", "odom", {2, 0, 0})}, false);
  EXPECT_THAT(sent_, IsEmpty()) << "where the vehicle is in odom is not known";
  EXPECT_THAT(bridge.why_no_vehicle(), HasSubstr("frames there are: map, odom, site"));
  bridge.on_transforms({at(10.1, "odom", "base_link", {0, 0, -5})}, false);
  ASSERT_EQ(sent_.size(), 1U);
  EXPECT_EQ(sent_[0].time_ns, 10'100'000'000);
  EXPECT_THAT(sent_[0].T_world_vehicle.position_m, IsVec3(Vec3{100, 1, -5}, 1e-9))
      << "half way, turned to port";
  EXPECT_FALSE(sent_[0].twist);

  bridge.on_transforms({at(10.3, "base_link", "camera", {1, 0, 0})}, false);
  EXPECT_EQ(sent_.size(), 1U) << "no news of the vehicle";
}

TEST_F(PoseBridgeTest, PausedSimulationKeepsSending) {
  PoseBridge& bridge = tree_bridge();
  for (int i = 0; i < 3; ++i) {
    bridge.on_transforms({at(10, "map", "base_link", {1, 0, 0})}, false);
  }
  EXPECT_EQ(sent_.size(), 3U);
  EXPECT_EQ(bridge.counters().clock_resets, 0U);
}

TEST_F(PoseBridgeTest, ResetForgetsAllButStaticTransforms) {
  PoseBridge& bridge = tree_bridge();
  bridge.on_transforms({at(0, "map", "odom", {100, 0, 0})}, true);
  bridge.on_transforms({at(50, "odom", "base_link", {1, 0, 0})}, false);
  bridge.on_transforms({at(49.9, "odom", "base_link", {7, 0, 0})}, false);
  ASSERT_EQ(sent_.size(), 2U);
  EXPECT_EQ(sent_[1].time_ns, 50 * second_ns) << "late, but no reset";
  bridge.on_transforms({at(0.1, "odom", "base_link", {2, 0, 0})}, false);
  bridge.on_transforms({at(0.2, "odom", "base_link", {3, 0, 0})}, false);
  ASSERT_EQ(sent_.size(), 4U);
  EXPECT_EQ(sent_[2].time_ns, 100'000'000);
  EXPECT_THAT(sent_[3].T_world_vehicle.position_m, IsVec3(Vec3{103, 0, 0}, 1e-9));
  EXPECT_EQ(bridge.counters().clock_resets, 1U);
  EXPECT_THAT(said_.back(), HasSubstr("the stamps of frame 'base_link' went back to 0.100 s"));
}

TEST_F(PoseBridgeTest, BodiesFollowTheirFrames) {
  PoseBridge& bridge = tree_bridge({{"crab_frame", "crab"}, {"never_seen", "fish"}});
  bridge.on_transforms({at(1, "map", "crab_frame", {0, 0, 0}), at(2, "map", "crab_frame", {4, 0, 0}),
                        at(1.25, "map", "base_link", {0, 0, 0})},
                       false);
  ASSERT_EQ(sent_.size(), 1U);
  ASSERT_EQ(sent_[0].bodies.size(), 1U);
  EXPECT_EQ(sent_[0].bodies[0].name, "crab");
  EXPECT_THAT(sent_[0].bodies[0].T_world_body.position_m, IsVec3(Vec3{1, 0, 0}, 1e-9))
      << "at the vehicle's time";

  bridge.on_transforms({at(3, "map", "base_link", {0, 0, 0})}, false);
  ASSERT_EQ(sent_.size(), 2U);
  EXPECT_THAT(sent_[1].bodies[0].T_world_body.position_m, IsVec3(Vec3{4, 0, 0}, 1e-9))
      << "the newest there is";
}

TEST_F(PoseBridgeTest, TransformsThatMeanNothingAreDropped) {
  PoseBridge& bridge = tree_bridge();
  bridge.on_transforms(
      {at(1, "map", "base_link", {0, 0, 0}, {0, 0, 0, 0}), at(1, "map", "base_link", {2e8, 0, 0})}, false);
  EXPECT_THAT(sent_, IsEmpty());
  EXPECT_EQ(bridge.counters().bad_value, 2U);
}

TEST_F(PoseBridgeTest, VehicleThatNeverMovesHasNoTime) {
  PoseBridge& bridge = tree_bridge();
  bridge.on_transforms({at(0, "map", "base_link", {1, 0, 0})}, true);
  bridge.on_transforms({at(1, "map", "other", {1, 0, 0})}, false);
  EXPECT_THAT(sent_, IsEmpty());
  EXPECT_EQ(bridge.counters().no_stamp, 1U);
}

}  // namespace
}  // namespace sonard::client
