// SPDX-License-Identifier: Apache-2.0
// A trajectory file as a source of poses.
#include "server/pose/trajectory_pose_source.hpp"

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
};

TEST_F(TrajectoryPoseSourceTest, PlaysInRealTimeAndRestsAtTheEnd) {
  TrajectoryPoseSource source{io_, {file(), false, 1.0, pose::Axes::enu_flu}, clock_, sink_};
  EXPECT_TRUE(delivered_.empty());
  const TimePoint began = clock_.now();
  source.start();
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
  TrajectoryPoseSource source{io_, {file(), true, 10.0, pose::Axes::enu_flu}, clock_, sink_};
  source.start();
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
  TrajectoryPoseSource source{io_, {file(), true, 1.0, pose::Axes::enu_flu}, clock_, sink_};
  source.start();
  ASSERT_TRUE(run_until_delivered(3));
  source.stop();
  const std::size_t count = delivered_.size();
  run_for(milliseconds{50});
  EXPECT_EQ(delivered_.size(), count);
}

TEST_F(TrajectoryPoseSourceTest, ABadFileIsReportedAtOnce) {
  const auto path = file();
  std::ofstream{path, std::ios::app} << "10.4,nan,0,0,0,0,0,1\n";
  try {
    TrajectoryPoseSource source{io_, {path, false, 1.0, pose::Axes::enu_flu}, clock_, sink_};
    FAIL() << "no error";
  } catch (const pose::TrajectoryError& error) {
    EXPECT_EQ(error.what(), path.string() + ":4: x is not finite");
  }
}

TEST_F(TrajectoryPoseSourceTest, EachConfiguredInputBecomesASource) {
  PoseConfig config;
  EXPECT_TRUE(make_pose_sources(io_, config, clock_, [&] { return sink_; }, {}).empty());
  config.udp = UdpPoseInput{{localhost, 0}, loopback};
  config.tcp = TcpPoseInput{{localhost, 0}, loopback, 8};
  config.trajectory = TrajectoryInput{file(), false, 1.0, pose::Axes::enu_flu};
  const auto sources = make_pose_sources(io_, config, clock_, [&] { return sink_; }, {});
  ASSERT_EQ(sources.size(), 3U);
  EXPECT_EQ(sources[0]->description(), "pose stream udp 127.0.0.1:0");
  EXPECT_EQ(sources[1]->description(), "pose stream tcp 127.0.0.1:0");
  EXPECT_EQ(sources[2]->description(), "pose trajectory " + file().string());
}

}  // namespace
}  // namespace sonard::server
