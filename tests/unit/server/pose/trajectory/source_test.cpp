// SPDX-License-Identifier: Apache-2.0
// A trajectory file as a source of poses.
#include "server/pose/trajectory/input.hpp"

#include <fstream>

#include "tests/unit/server/pose/source_fixture.hpp"

namespace sonard::server {
namespace {

using std::chrono::milliseconds;

class TrajectoryPoseSourceTest : public SourceTest {
 protected:
  /// A trajectory file: east at 1 m/s for 0.3 s.
  std::filesystem::path file() const {
    return write_file("t,x,y,z,qx,qy,qz,qw\n10,0,0,0,0,0,0,1\n10.3,0.3,0,0,0,0,0,1\n");
  }
  std::unique_ptr<PoseSource> open(TrajectoryInput input) {
    return pose_input(std::move(input))->open(io_, clock_, sink_, {});
  }
};

TEST_F(TrajectoryPoseSourceTest, PlaysInRealTimeAndRestsAtTheEnd) {
  const auto source = open({file(), false, 1.0, pose::Axes::enu_flu});
  EXPECT_TRUE(delivered_.empty());
  const TimePoint began = clock_.now();
  source->start();
  ASSERT_EQ(delivered_.size(), 1U) << "the first pose comes at once";
  EXPECT_TRUE(run_until([&] { return delivered_.back().sample.T_world_vehicle.position_m.x == 0.3; }));
  EXPECT_GE(clock_.now() - began, milliseconds{300});
  ASSERT_TRUE(delivered_.back().sample.twist);
  EXPECT_EQ(delivered_.back().sample.twist->linear_mps.x, 0.0);
  for (const Delivery& delivery : delivered_) {
    const double x = delivery.sample.T_world_vehicle.position_m.x;
    const double played_s = 1e-9 * static_cast<double>((delivery.arrival - delivered_[0].arrival).count());
    EXPECT_NEAR(x, std::min(delivered_[0].sample.T_world_vehicle.position_m.x + played_s, 0.3), 1e-9);
    EXPECT_EQ(delivery.sample.time_ns, delivery.arrival.count());
  }
  const std::size_t count = delivered_.size();
  run_for(milliseconds{50});
  EXPECT_EQ(delivered_.size(), count) << "nothing more comes after the end";
}

TEST_F(TrajectoryPoseSourceTest, LoopsAndScalesTime) {
  const auto source = open({file(), true, 10.0, pose::Axes::enu_flu});
  source->start();
  int rounds = 0;
  std::size_t seen = 1;
  EXPECT_TRUE(run_until([&] {
    for (; seen < delivered_.size(); ++seen) {
      rounds += delivered_[seen].sample.T_world_vehicle.position_m.x <
                        delivered_[seen - 1].sample.T_world_vehicle.position_m.x
                    ? 1
                    : 0;
    }
    return rounds >= 3;
  }));
  EXPECT_NEAR(delivered_.back().sample.twist->linear_mps.x, 10.0, 1e-6);
}

TEST_F(TrajectoryPoseSourceTest, StopEndsIt) {
  const auto source = open({file(), true, 1.0, pose::Axes::enu_flu});
  source->start();
  ASSERT_TRUE(run_until_delivered(3));
  source->stop();
  const std::size_t count = delivered_.size();
  run_for(milliseconds{50});
  EXPECT_EQ(delivered_.size(), count);
}

TEST_F(TrajectoryPoseSourceTest, ABadFileIsReportedAtOnce) {
  const auto path = file();
  std::ofstream{path, std::ios::app} << "10.4,nan,0,0,0,0,0,1\n";
  try {
    open({path, false, 1.0, pose::Axes::enu_flu});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.where, "poses.trajectory.file");
    EXPECT_EQ(error.what(), path.string() + ":4: x is not finite");
  }
}

TEST_F(TrajectoryPoseSourceTest, GivesTheFirstPoseBeforeItIsOpened) {
  const auto input = pose_input(TrajectoryInput{.file = file()});
  EXPECT_EQ(input->summary(), "trajectory " + file().string() + " (2 poses, 0.3 s)");
  ASSERT_TRUE(input->first_pose());
  EXPECT_EQ(input->first_pose()->key, "poses.trajectory.file");
  EXPECT_EQ(input->first_pose()->T_world_vehicle.position_m, glm::dvec3(0.0));
  EXPECT_FALSE(pose_input(TrajectoryInput{.file = "/absent"})->first_pose());
}

}  // namespace
}  // namespace sonard::server
