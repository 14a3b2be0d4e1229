// SPDX-License-Identifier: Apache-2.0
// The pose source receives poses from node-mavlink over loopback. This compares their numbers;
// mavlink_test.py compares the image.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "server/pose/mavlink/source.hpp"
#include "tests/unit/protocol/pose/pose_matchers.hpp"
#include "tests/unit/server/pose/child_process.hpp"
#include "tests/unit/server/pose/source_fixture.hpp"

namespace sonard::server {
namespace {

using pose::IsVec3;
using pose::Vec3;
using std::chrono::seconds;
using test::ChildProcess;
using testing::HasSubstr;

class MavlinkPublisherTest : public SourceTest {
 protected:
  /// Checks the poses of a vehicle at 1.5 m north, -2.5 m east, 3 m down, heading east, pitched up by 30
  /// degrees and rolled by 10.
  void follow(const std::string& kind, const std::string& version) {
    MavlinkPoseInput input;
    input.bind = {localhost, 0};
    input.allow = loopback;
    MavlinkPoseSource source{io_, input, clock_, sink_};
    source.start();
    ChildProcess vehicle{{"node", PUBLISHER, std::to_string(source.local_endpoint().port), version, kind,
                          "1.5", "-2.5", "3", "10", "30", "90"}};
    ASSERT_TRUE(run_until([&] { return delivered_.size() >= 20; }, seconds{60})) << vehicle.output();
    for (const Delivery& delivery : delivered_) {
      expect_pose(delivery.sample);
    }
    // Stamps advance as arrivals do; both are uneven on a shared processor.
    const double stamped_s =
        1e-9 * static_cast<double>(delivered_.back().sample.time_ns - delivered_[0].sample.time_ns);
    EXPECT_NEAR(stamped_s, 0.4, 0.3);
    EXPECT_EQ(source.counters().malformed + source.counters().bad_value, 0U);
    EXPECT_THAT(source.details(),
                HasSubstr(" bad_checksums=0 unknown_flags=0 stray_bytes=0 wrong_system=0 "));
  }

  static void expect_pose(const pose::PoseSample& sample) {
    const double up = std::numbers::pi / 6;
    const double rolled = std::numbers::pi / 18;
    const pose::Quat& q = sample.T_world_vehicle.orientation;
    EXPECT_THAT(sample.T_world_vehicle.position_m, IsVec3(Vec3{-2.5, 1.5, -3}, 1e-6));
    EXPECT_THAT(rotate(q, {1, 0, 0}), IsVec3(Vec3{std::cos(up), 0, std::sin(up)}, 1e-6));
    // Without the roll, port is north; the roll lifts port towards the vehicle's own top.
    EXPECT_THAT(rotate(q, {0, 1, 0}), IsVec3(Vec3{-std::sin(rolled) * std::sin(up), std::cos(rolled),
                                                  std::sin(rolled) * std::cos(up)},
                                             1e-6));
    ASSERT_TRUE(sample.twist);
    EXPECT_THAT(sample.twist->linear_mps, IsVec3(Vec3{}, 0.0));
  }
};

TEST_F(MavlinkPublisherTest, OdometryOfVersion2) {
  follow("odometry", "2");
}

TEST_F(MavlinkPublisherTest, PositionAndAnglesOfBothVersions) {
  follow("angles", "1");
  delivered_.clear();
  follow("angles", "2");
}

TEST_F(MavlinkPublisherTest, PositionAndQuaternionOfBothVersions) {
  follow("quaternion", "1");
  delivered_.clear();
  follow("quaternion", "2");
}

}  // namespace
}  // namespace sonard::server
