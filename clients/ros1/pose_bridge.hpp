// SPDX-License-Identifier: Apache-2.0
// From what ROS says to what sonard is told.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "clients/ros1/messages/frame_tree.hpp"
#include "clients/ros1/messages/ros_pose.hpp"
#include "protocol/pose/pose_codec.hpp"

namespace sonard::client {

/// A frame of tf that a body of sonard's world follows.
struct FollowedFrame {
  std::string frame;
  std::string body;  ///< its name in the world
};

struct BridgeSettings {
  std::string world_frame = "world";  ///< the frame that is sonard's world
  /// The vehicle. With odometry the child_frame_id that is expected, any when empty; without, its frame of
  /// tf.
  std::string vehicle_frame;
  bool vehicle_from_odometry = false;
  pose::Axes axes = pose::Axes::enu_flu;  ///< of world, vehicle and bodies
  std::vector<FollowedFrame> bodies;
};

struct BridgeCounters {
  std::uint64_t poses = 0;        ///< handed on
  std::uint64_t wrong_frame = 0;  ///< odometry in or of another frame than expected
  std::uint64_t no_stamp = 0;     ///< stamp of 0: no time to put the pose at
  std::uint64_t bad_value = 0;    ///< not finite, no rotation, beyond every limit
  std::uint64_t clock_resets = 0;
};

/// Pure but for its two callbacks. One thread.
class PoseBridge {
 public:
  using Send = std::function<void(const pose::PoseSample&)>;
  /// One line for a person. What would be said for every message is said once.
  using Say = std::function<void(const std::string&)>;

  PoseBridge(BridgeSettings settings, Send send, Say say);

  void on_odometry(RosPose message);
  /// All transforms of one message of /tf (false) or /tf_static (true).
  void on_transforms(const std::vector<RosPose>& transforms, bool is_static);

  const BridgeCounters& counters() const { return counters_; }
  /// Why tf gives no pose of the vehicle: tf2's reason and the frames that there are. One line.
  std::string why_no_vehicle() const;

 private:
  /// Makes its quaternion one of norm 1; false, counted and said, where its numbers mean nothing.
  bool normalize(RosPose& message, const std::string& what);
  void send_from_tree(const std::vector<RosPose>& news);
  void send(const RosPose& vehicle);
  pose::Transform to_enu_flu(const pose::Transform& T) const;
  void say_once(const std::string& line);

  BridgeSettings settings_;
  Send send_;
  Say say_;
  FrameTree tree_;
  BridgeCounters counters_;
  std::int64_t newest_ns_ = 0;  ///< of the vehicle by tf, as far as sent
  std::set<std::string> said_;
};

}  // namespace sonard::client
