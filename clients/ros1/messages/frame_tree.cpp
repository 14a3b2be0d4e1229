// SPDX-License-Identifier: Apache-2.0
#include "clients/ros1/messages/frame_tree.hpp"

#include <console_bridge/console.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>

#include <algorithm>

namespace sonard::client {
namespace {

/// As sonard's own sources: more than what comes late over a network.
constexpr std::int64_t set_back_ns = 250'000'000;

ros::Time to_ros(std::int64_t stamp_ns) {
  ros::Time time;
  time.fromNSec(static_cast<std::uint64_t>(stamp_ns));
  return time;
}

geometry_msgs::TransformStamped to_ros(const RosPose& pose) {
  geometry_msgs::TransformStamped message;
  message.header.stamp = to_ros(pose.stamp_ns);
  message.header.frame_id = pose.frame;
  message.child_frame_id = pose.child_frame;
  const pose::Transform& T = pose.T_frame_child;
  message.transform.translation.x = T.position_m.x;
  message.transform.translation.y = T.position_m.y;
  message.transform.translation.z = T.position_m.z;
  message.transform.rotation.w = T.orientation.w;
  message.transform.rotation.x = T.orientation.x;
  message.transform.rotation.y = T.orientation.y;
  message.transform.rotation.z = T.orientation.z;
  return message;
}

RosPose from_ros(const geometry_msgs::TransformStamped& message) {
  const auto& p = message.transform.translation;
  const auto& q = message.transform.rotation;
  RosPose pose;
  pose.frame = message.header.frame_id;
  pose.child_frame = message.child_frame_id;
  pose.stamp_ns = static_cast<std::int64_t>(message.header.stamp.toNSec());
  pose.T_frame_child = {{p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}};
  return pose;
}

}  // namespace

struct FrameTree::Buffer {
  tf2::BufferCore core;

  Lookup look_up(const std::string& root, const std::string& frame, const ros::Time& time) const {
    try {
      return {from_ros(core.lookupTransform(root, frame, time)), {}};
    } catch (const tf2::TransformException& error) {
      return {std::nullopt, error.what()};
    }
  }
};

FrameTree::FrameTree() : buffer_(std::make_unique<Buffer>()) {
  // tf2 writes a line for every transform it has heard before, so for each one of a paused simulation.
  console_bridge::noOutputHandler();
}

FrameTree::~FrameTree() = default;

bool FrameTree::insert(const RosPose& transform, bool is_static) {
  bool reset = false;
  if (!is_static) {
    const auto [newest, first] = newest_ns_.try_emplace(transform.child_frame, transform.stamp_ns);
    reset = !first && transform.stamp_ns < newest->second - set_back_ns;
    if (reset) {
      buffer_->core.clear();  // which leaves static ones alone
      newest_ns_.clear();
    }
    std::int64_t& newest_ns = newest_ns_[transform.child_frame];
    newest_ns = reset ? transform.stamp_ns : std::max(newest_ns, transform.stamp_ns);
  }
  buffer_->core.setTransform(to_ros(transform), std::string{}, is_static);
  return reset;
}

FrameTree::Lookup FrameTree::newest(const std::string& root, const std::string& frame) const {
  return buffer_->look_up(root, frame, ros::Time{});
}

FrameTree::Lookup FrameTree::at(std::int64_t stamp_ns, const std::string& root,
                                const std::string& frame) const {
  Lookup found = buffer_->look_up(root, frame, to_ros(stamp_ns));
  return found.pose ? found : newest(root, frame);
}

std::vector<std::string> FrameTree::frames() const {
  std::vector<std::string> names;
  buffer_->core._getFrameStrings(names);
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace sonard::client
