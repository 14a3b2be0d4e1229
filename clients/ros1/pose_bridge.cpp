// SPDX-License-Identifier: Apache-2.0
#include "clients/ros1/pose_bridge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace sonard::client {
namespace {

bool sane(const pose::Vec3& v) {
  return pose::is_finite(v) && pose::norm(v) <= pose::max_speed;
}

}  // namespace

PoseBridge::PoseBridge(BridgeSettings settings, Send send, Say say)
    : settings_(std::move(settings)), send_(std::move(send)), say_(std::move(say)) {
  settings_.world_frame = without_slash(settings_.world_frame);
  settings_.vehicle_frame = without_slash(settings_.vehicle_frame);
  for (FollowedFrame& body : settings_.bodies) {
    body.frame = without_slash(body.frame);
  }
}

void PoseBridge::say_once(const std::string& line) {
  if (said_.insert(line).second) {
    say_(line);
  }
}

bool PoseBridge::normalize(RosPose& message, const std::string& what) {
  const pose::TransformFault fault = pose::normalize(message.T_frame_child);
  if (fault != pose::TransformFault::none) {
    ++counters_.bad_value;
    say_once(fmt::format("{} is dropped: {}", what, pose::describe(fault)));
    return false;
  }
  if (message.twist && !(sane(message.twist->linear_mps) && sane(message.twist->angular_radps))) {
    ++counters_.bad_value;
    say_once(fmt::format("{} is dropped: twist is not finite, or beyond 1e6", what));
    return false;
  }
  return true;
}

void PoseBridge::on_odometry(RosPose message) {
  const std::string frame = without_slash(message.frame);
  const std::string child = without_slash(message.child_frame);
  if (frame != settings_.world_frame) {
    ++counters_.wrong_frame;
    say_once(
        fmt::format("odometry with frame_id '{}' is dropped: expected '{}'. If '{}' is what sonard's world "
                    "is, say --world-frame {}, and --axes ned_frd where its z points down",
                    frame, settings_.world_frame, frame, frame));
    return;
  }
  if (!settings_.vehicle_frame.empty() && child != settings_.vehicle_frame) {
    ++counters_.wrong_frame;
    say_once(fmt::format("odometry with child_frame_id '{}' is dropped: expected '{}' (--vehicle-frame)",
                         child, settings_.vehicle_frame));
    return;
  }
  if (message.stamp_ns == 0) {
    ++counters_.no_stamp;
    say_once("odometry with a header.stamp of 0 is dropped: its publisher has to fill in the time");
    return;
  }
  if (normalize(message, "odometry")) {
    send(message);
  }
}

void PoseBridge::on_transforms(const std::vector<RosPose>& transforms, bool is_static) {
  for (RosPose transform : transforms) {
    transform.frame = without_slash(transform.frame);
    transform.child_frame = without_slash(transform.child_frame);
    if (normalize(transform, fmt::format("the transform to '{}'", transform.child_frame)) &&
        tree_.insert(transform, is_static)) {
      ++counters_.clock_resets;
      newest_ns_ = 0;
      say_(
          fmt::format("the stamps of frame '{}' went back to {:.3f} s: transforms from before are forgotten. "
                      "Again and again: two publishers of one frame",
                      transform.child_frame, 1e-9 * static_cast<double>(transform.stamp_ns)));
    }
  }
  if (!settings_.vehicle_from_odometry && !is_static) {
    send_from_tree(transforms);
  }
}

void PoseBridge::send_from_tree(const std::vector<RosPose>& news) {
  const FrameTree::Lookup vehicle = tree_.newest(settings_.world_frame, settings_.vehicle_frame);
  if (!vehicle.pose) {
    return;  // the rest of the chain may come in another message; why_no_vehicle() is for who waits in vain
  }
  if (vehicle.pose->stamp_ns == 0) {
    ++counters_.no_stamp;
    say_once(fmt::format("nothing between '{}' and '{}' ever changes: give this pose as poses.initial",
                         settings_.world_frame, settings_.vehicle_frame));
    return;
  }
  // Other frames bring no news of the vehicle. The same time again is that of a paused simulation.
  const bool again = vehicle.pose->stamp_ns == newest_ns_ &&
                     std::any_of(news.begin(), news.end(), [this](const RosPose& transform) {
                       return without_slash(transform.child_frame) == settings_.vehicle_frame;
                     });
  if (vehicle.pose->stamp_ns > newest_ns_ || again) {
    newest_ns_ = vehicle.pose->stamp_ns;
    send(*vehicle.pose);
  }
}

void PoseBridge::send(const RosPose& vehicle) {
  pose::PoseSample sample;
  sample.time_ns = vehicle.stamp_ns;
  sample.T_world_vehicle = to_enu_flu(vehicle.T_frame_child);
  sample.twist = vehicle.twist;
  if (sample.twist && settings_.axes == pose::Axes::ned_frd) {
    sample.twist = pose::flu_from_frd(*sample.twist);
  }
  for (const FollowedFrame& followed : settings_.bodies) {
    const FrameTree::Lookup body = tree_.at(vehicle.stamp_ns, settings_.world_frame, followed.frame);
    if (body.pose) {
      sample.bodies.push_back({followed.body, to_enu_flu(body.pose->T_frame_child)});
    }
  }
  if (counters_.poses++ == 0) {
    const pose::Vec3& p = sample.T_world_vehicle.position_m;
    say_(fmt::format("first pose: '{}' in '{}' at {:.3f} s, ({:.2f}, {:.2f}, {:.2f}) east, north, up",
                     vehicle.child_frame, vehicle.frame, 1e-9 * static_cast<double>(vehicle.stamp_ns), p.x,
                     p.y, p.z));
  }
  send_(sample);
}

pose::Transform PoseBridge::to_enu_flu(const pose::Transform& T) const {
  return settings_.axes == pose::Axes::ned_frd ? pose::enu_flu_from_ned_frd(T) : T;
}

std::string PoseBridge::why_no_vehicle() const {
  const FrameTree::Lookup vehicle = tree_.newest(settings_.world_frame, settings_.vehicle_frame);
  return fmt::format("{}; frames there are: {}", vehicle.problem, fmt::join(tree_.frames(), ", "));
}

}  // namespace sonard::client
