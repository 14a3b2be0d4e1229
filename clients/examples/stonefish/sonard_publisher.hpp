// SPDX-License-Identifier: Apache-2.0
// Sends the samples of a Stonefish sf::Odometry sensor to sonard, one UDP datagram each. Needs protobuf, and
// the message, which you generate once:
//     protoc --proto_path=protocol/pose --cpp_out=. pose.proto
#pragma once

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "pose.pb.h"

/// Stonefish's world is north, east, down; its vehicles have x forward, y to starboard, z down. sonard
/// supports this frame, so the numbers are sent unchanged. `Sample` is sf::Sample; the twist of sf::Odometry
/// already is in the sensor's axes.
template <class Sample>
sonard::pose::PoseUpdate pose_update(const Sample& odometry) {
  sonard::pose::PoseUpdate update;
  update.set_time_ns(std::llround(odometry.getTimestamp() * 1e9));
  update.set_frame(sonard::pose::FRAME_NED_FRD);
  const auto fill = [&odometry](sonard::pose::Vector3& vector, int first) {
    vector.set_x(odometry.getValue(first));
    vector.set_y(odometry.getValue(first + 1));
    vector.set_z(odometry.getValue(first + 2));
  };
  fill(*update.mutable_vehicle()->mutable_position_m(), 0);
  fill(*update.mutable_twist()->mutable_linear_mps(), 3);
  sonard::pose::Quaternion& orientation = *update.mutable_vehicle()->mutable_orientation();
  orientation.set_x(odometry.getValue(6));
  orientation.set_y(odometry.getValue(7));
  orientation.set_z(odometry.getValue(8));
  orientation.set_w(odometry.getValue(9));
  fill(*update.mutable_twist()->mutable_angular_radps(), 10);
  return update;
}

/// Make it a member of your sf::SimulationManager, and call send() in SimulationStepCompleted().
class SonardPublisher {
 public:
  explicit SonardPublisher(const std::string& address = "127.0.0.1", std::uint16_t port = 14600)
      : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    receiver_.sin_family = AF_INET;
    receiver_.sin_port = htons(port);
    if (socket_ < 0 || inet_pton(AF_INET, address.c_str(), &receiver_.sin_addr) != 1) {
      throw std::runtime_error("cannot reach sonard at '" + address + "'");
    }
  }
  ~SonardPublisher() { close(socket_); }
  SonardPublisher(const SonardPublisher&) = delete;
  SonardPublisher& operator=(const SonardPublisher&) = delete;

  /// Sends only samples with a new time, because the physics may run at 500 steps per second or more.
  template <class Sample>
  void send(const Sample& odometry) {
    const sonard::pose::PoseUpdate update = pose_update(odometry);
    if (update.time_ns() != sent_ns_) {
      sent_ns_ = update.time_ns();
      const std::string bytes = update.SerializeAsString();
      // A lost datagram does no harm: the next one is newer.
      sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&receiver_),
             sizeof receiver_);
    }
  }

 private:
  int socket_;
  sockaddr_in receiver_{};
  std::int64_t sent_ns_ = -1;
};
