// SPDX-License-Identifier: Apache-2.0
// The node: what roscpp does for the bridge.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "clients/ros1/messages/ros_pose.hpp"

namespace sonard::client {

/// Takes ROS's own arguments (`__name:=`, `topic:=other`) out of the command line. Once, before anything
/// else.
void initialize_ros(int& argc, char** argv);

/// "http://localhost:11311", from ROS_MASTER_URI.
std::string ros_master();
/// Asks it; does not wait for one.
bool ros_master_answers();

/// Subscriptions of one node. Everything happens on the thread that calls spin().
class RosNode {
 public:
  struct Handlers {
    std::function<void(const RosPose&)> odometry;
    /// All transforms of one message of /tf (false) or /tf_static (true).
    std::function<void(const std::vector<RosPose>&, bool is_static)> transforms;
  };

  /// The master answers. An empty `odometry_topic`, and `with_tf` false, subscribe to less.
  RosNode(std::string odometry_topic, bool with_tf, Handlers handlers);
  ~RosNode();

  /// Waits until messages come, at most `patience`, and hands them out.
  void spin(std::chrono::milliseconds patience);
  /// Tells the master again what is subscribed to: it may be a new one.
  void subscribe();
  /// False when ROS has ended this node, because another one with its name has come.
  bool alive() const;

  /// With names resolved: "/rexrov/pose_gt".
  std::string odometry_topic() const;
  /// Types of all topics that someone publishes, by name. Empty when the master does not answer.
  static std::map<std::string, std::string> published();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::client
