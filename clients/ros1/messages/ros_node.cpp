// SPDX-License-Identifier: Apache-2.0
#include "clients/ros1/messages/ros_node.hpp"

#include <nav_msgs/Odometry.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <tf2_msgs/TFMessage.h>

#include <utility>

namespace sonard::client {
namespace {

/// Messages that wait while one is sent on. The oldest go first.
constexpr std::uint32_t queue_messages = 100;

template <class Vector>
pose::Vec3 vec3(const Vector& v) {
  return {v.x, v.y, v.z};
}

pose::Quat quat(const geometry_msgs::Quaternion& q) {
  return {q.w, q.x, q.y, q.z};
}

std::int64_t stamp_ns(const std_msgs::Header& header) {
  return static_cast<std::int64_t>(header.stamp.toNSec());
}

}  // namespace

void initialize_ros(int& argc, char** argv) {
  ros::init(argc, argv, "roscast", ros::init_options::NoSigintHandler | ros::init_options::AnonymousName);
  // Else a master that goes away while it is asked would be waited for.
  ros::master::setRetryTimeout(ros::WallDuration{2.0});
}

std::string ros_master() {
  return ros::master::getURI();
}

bool ros_master_answers() {
  return ros::master::check();
}

struct RosNode::Impl {
  void on_odometry(const nav_msgs::Odometry& message) const {
    const pose::Velocity twist{vec3(message.twist.twist.linear), vec3(message.twist.twist.angular)};
    handlers.odometry({message.header.frame_id,
                       message.child_frame_id,
                       stamp_ns(message.header),
                       {vec3(message.pose.pose.position), quat(message.pose.pose.orientation)},
                       twist});
  }

  void on_transforms(const tf2_msgs::TFMessage& message, bool is_static) const {
    std::vector<RosPose> transforms;
    for (const geometry_msgs::TransformStamped& one : message.transforms) {
      transforms.push_back({one.header.frame_id,
                            one.child_frame_id,
                            stamp_ns(one.header),
                            {vec3(one.transform.translation), quat(one.transform.rotation)},
                            {}});
    }
    handlers.transforms(transforms, is_static);
  }

  std::string topic;
  bool with_tf = false;
  Handlers handlers;
  ros::CallbackQueue queue;
  ros::NodeHandle node;
  std::vector<ros::Subscriber> subscribers;
};

RosNode::RosNode(std::string odometry_topic, bool with_tf, Handlers handlers)
    : impl_(std::make_unique<Impl>()) {
  impl_->topic = std::move(odometry_topic);
  impl_->with_tf = with_tf;
  impl_->handlers = std::move(handlers);
  impl_->node.setCallbackQueue(&impl_->queue);
  subscribe();
}

RosNode::~RosNode() {
  impl_->subscribers.clear();
  ros::shutdown();
}

void RosNode::spin(std::chrono::milliseconds patience) {
  impl_->queue.callAvailable(ros::WallDuration{std::chrono::duration<double>(patience).count()});
}

void RosNode::subscribe() {
  Impl& self = *impl_;
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  using OnTransforms = boost::function<void(const tf2_msgs::TFMessage::ConstPtr&)>;
  const auto transforms = [&self](bool is_static) -> OnTransforms {
    return [&self, is_static](const tf2_msgs::TFMessage::ConstPtr& message) {
      self.on_transforms(*message, is_static);
    };
  };
  self.subscribers.clear();
  if (!self.topic.empty()) {
    const boost::function<void(const nav_msgs::Odometry::ConstPtr&)> odometry =
        [&self](const nav_msgs::Odometry::ConstPtr& message) { self.on_odometry(*message); };
    self.subscribers.push_back(
        self.node.subscribe<nav_msgs::Odometry>(self.topic, queue_messages, odometry, nullptr, hints));
  }
  if (self.with_tf) {
    self.subscribers.push_back(
        self.node.subscribe<tf2_msgs::TFMessage>("/tf", queue_messages, transforms(false), nullptr, hints));
    self.subscribers.push_back(self.node.subscribe<tf2_msgs::TFMessage>("/tf_static", queue_messages,
                                                                        transforms(true), nullptr, hints));
  }
}

bool RosNode::alive() const {
  return ros::ok();
}

std::string RosNode::odometry_topic() const {
  return impl_->topic.empty() ? std::string{} : impl_->node.resolveName(impl_->topic);
}

std::map<std::string, std::string> RosNode::published() {
  ros::master::V_TopicInfo topics;
  std::map<std::string, std::string> types;
  if (ros::master::getTopics(topics)) {
    for (const ros::master::TopicInfo& topic : topics) {
      types[topic.name] = topic.datatype;
    }
  }
  return types;
}

}  // namespace sonard::client
