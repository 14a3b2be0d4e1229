// SPDX-License-Identifier: Apache-2.0
// A simulator's pose topic, by the stock library: publishes entities at rest 50 times a second, for some
// seconds. The stamp runs at a rate of simulated time. gazebo_publisher TOPIC SECONDS TIME_RATE TYPE NAME X Y
// Z ROLL PITCH YAW [NAME X ...] Metres, and degrees about the fixed axes x, y and z, in this order.
#include <ignition/msgs/pose_v.pb.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ignition/math/Quaternion.hh>
#include <ignition/transport/Node.hh>
#include <numbers>
#include <string>
#include <thread>

namespace {

constexpr int first_entity = 5;
constexpr int words_of_entity = 7;

ignition::msgs::Pose_V poses_of(char** words, int count) {
  ignition::msgs::Pose_V poses;
  for (int i = 0; i + words_of_entity <= count; i += words_of_entity) {
    const auto number = [&](int word) { return std::atof(words[i + word]); };
    const auto radians = [&](int word) { return number(word) * std::numbers::pi / 180.0; };
    auto* const pose = poses.add_pose();
    pose->set_name(words[i]);
    pose->mutable_position()->set_x(number(1));
    pose->mutable_position()->set_y(number(2));
    pose->mutable_position()->set_z(number(3));
    const ignition::math::Quaterniond q(radians(4), radians(5), radians(6));
    pose->mutable_orientation()->set_w(q.W());
    pose->mutable_orientation()->set_x(q.X());
    pose->mutable_orientation()->set_y(q.Y());
    pose->mutable_orientation()->set_z(q.Z());
  }
  return poses;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < first_entity + words_of_entity || (argc - first_entity) % words_of_entity != 0) {
    return 64;
  }
  ignition::transport::Node node;
  auto publisher = node.Advertise(argv[1], std::string(argv[4]));
  if (!publisher) {
    return 1;
  }
  ignition::msgs::Pose_V poses = poses_of(argv + first_entity, argc - first_entity);
  const int count = static_cast<int>(std::atof(argv[2]) * 50);
  for (int i = 0; i < count; ++i) {
    const double time_s = 0.02 * i * std::atof(argv[3]);
    auto* const stamp = poses.mutable_header()->mutable_stamp();
    stamp->set_sec(static_cast<std::int64_t>(time_s));
    stamp->set_nsec(static_cast<int>((time_s - std::floor(time_s)) * 1e9));
    publisher.PublishRaw(poses.SerializeAsString(), argv[4]);
    std::this_thread::sleep_for(std::chrono::milliseconds{20});
  }
  return 0;
}
