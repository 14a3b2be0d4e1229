// SPDX-License-Identifier: Apache-2.0
// What each type of pose source says about an input before it is opened.
#include "server/pose/types/types.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/pose/gazebo/input.hpp"
#include "server/pose/mavlink/input.hpp"
#include "server/pose/tcp/input.hpp"
#include "server/pose/trajectory/input.hpp"
#include "server/pose/udp/input.hpp"

namespace sonard::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr Endpoint bind{0x7F000001, 14600};

TEST(PoseSourceTypes, AreListedInTheOrderOfTheDocuments) {
  std::vector<std::string> keys, live;
  for (const PoseSourceType* type : pose_source_types()) {
    keys.emplace_back(type->key);
    if (type->is_live) {
      live.emplace_back(type->key);
    }
  }
  EXPECT_THAT(keys, ElementsAre("udp", "tcp", "mavlink", "gazebo", "trajectory"));
  EXPECT_THAT(live, ElementsAre("udp", "tcp", "mavlink", "gazebo"));
}

TEST(PoseSourceTypes, SayWhatCheckPrints) {
  EXPECT_EQ(pose_input(UdpPoseInput{bind, {}})->summary(), "UDP 127.0.0.1:14600");
  EXPECT_EQ(pose_input(TcpPoseInput{bind, {}})->summary(), "TCP 127.0.0.1:14600");
  MavlinkPoseInput mavlink;
  mavlink.bind = bind;
  mavlink.system_id = 7;
  EXPECT_EQ(pose_input(mavlink)->summary(), "MAVLink UDP 127.0.0.1:14600 (system 7)");
  GazeboPoseInput gazebo;
  gazebo.topic = "/world/sea/pose/info";
  gazebo.vehicle.name = "rov";
  EXPECT_EQ(pose_input(gazebo)->summary(), "gazebo /world/sea/pose/info entity 'rov'");
}

TEST(PoseSourceTypes, NameTheirSockets) {
  const auto expect_socket = [](const PoseInput& input, PlannedSocket::Transport transport,
                                const std::string& key) {
    const std::optional<PlannedSocket> socket = input.socket();
    ASSERT_TRUE(socket) << key;
    EXPECT_EQ(socket->transport, transport) << key;
    EXPECT_EQ(socket->endpoint, bind) << key;
    EXPECT_EQ(socket->key, key);
  };
  MavlinkPoseInput mavlink;
  mavlink.bind = bind;
  expect_socket(*pose_input(UdpPoseInput{bind, {}}), PlannedSocket::Transport::udp, "poses.udp.bind");
  expect_socket(*pose_input(TcpPoseInput{bind, {}}), PlannedSocket::Transport::tcp, "poses.tcp.bind");
  expect_socket(*pose_input(mavlink), PlannedSocket::Transport::udp, "poses.mavlink.bind");
  EXPECT_FALSE(pose_input(GazeboPoseInput{})->socket());
  EXPECT_FALSE(pose_input(TrajectoryInput{})->socket());
}

TEST(PoseSourceTypes, TakeFromTheWorldOnlyWhatTheyNeed) {
  std::vector<ConfigProblem> problems;
  const WorldOfPoses world{"rov", render::GeographicOrigin{43.0, 5.0, 0.0}};
  EXPECT_EQ(pose_input(UdpPoseInput{})->in_world(world, problems), nullptr);
  EXPECT_EQ(pose_input(TcpPoseInput{})->in_world(world, problems), nullptr);
  EXPECT_EQ(pose_input(TrajectoryInput{})->in_world(world, problems), nullptr);
  EXPECT_NE(pose_input(MavlinkPoseInput{})->in_world(world, problems), nullptr);
  EXPECT_EQ(pose_input(GazeboPoseInput{})->in_world(world, problems)->summary(), "gazebo  entity 'rov'");
  EXPECT_THAT(problems, IsEmpty());
}

}  // namespace
}  // namespace sonard::server
