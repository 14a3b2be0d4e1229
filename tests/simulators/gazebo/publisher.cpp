// A simulator's share of a pose topic, by the stock library: for some seconds, 50 times a second, the pose of
// `rov` at (1, 2, -3), a quarter turn to port, and of `crab`. The stamp runs at a rate of simulated time.
// ignition_publisher TOPIC SECONDS TIME_RATE TYPE
#include <ignition/msgs/pose_v.pb.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ignition/transport/Node.hh>
#include <string>
#include <thread>

namespace {

std::string world_at(double time_s) {
  ignition::msgs::Pose_V poses;
  auto* const stamp = poses.mutable_header()->mutable_stamp();
  stamp->set_sec(static_cast<std::int64_t>(time_s));
  stamp->set_nsec(static_cast<int>((time_s - std::floor(time_s)) * 1e9));
  for (const char* name : {"rov", "crab"}) {
    auto* const pose = poses.add_pose();
    pose->set_name(name);
    pose->mutable_position()->set_x(1);
    pose->mutable_position()->set_y(2);
    pose->mutable_position()->set_z(-3);
    pose->mutable_orientation()->set_w(std::sqrt(0.5));
    pose->mutable_orientation()->set_z(std::sqrt(0.5));
  }
  return poses.SerializeAsString();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    return 64;
  }
  ignition::transport::Node node;
  auto publisher = node.Advertise(argv[1], std::string(argv[4]));
  if (!publisher) {
    return 1;
  }
  const int count = static_cast<int>(std::atof(argv[2]) * 50);
  for (int i = 0; i < count; ++i) {
    publisher.PublishRaw(world_at(0.02 * i * std::atof(argv[3])), argv[4]);
    std::this_thread::sleep_for(std::chrono::milliseconds{20});
  }
  return 0;
}
