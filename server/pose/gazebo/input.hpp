// SPDX-License-Identifier: Apache-2.0
// The section `poses.gazebo`: poses of a Gazebo simulation.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/pose.hpp"
#include "server/net/addresses.hpp"
#include "server/pose/pose_input.hpp"

namespace sonard::server {

/// An entity whose pose a simulator sends, by its name in the simulator.
struct SimulatorEntity {
  std::string name;
  /// The entities that each pose is relative to, from a model in the world inwards. Empty: the pose of the
  /// entity is in the world.
  std::vector<std::string> parents;
};

/// A topic of Gazebo (Ignition or gz transport) with poses (docs/simulators/gazebo.md).
struct GazeboPoseInput {
  struct Body {
    SimulatorEntity entity;
    std::string body;  ///< of our world
  };
  std::string topic;
  std::string partition;      ///< empty: the value of IGN_PARTITION
  Ipv4 address = 0x7F000001;  ///< of this machine; loopback: Gazebo on this machine only
  /// Carrier of the sonars. Without a name: the model of the vehicle (PoseInput::in_world() sets it).
  SimulatorEntity vehicle;
  render::Pose T_entity_vehicle;  ///< mount of the vehicle frame on that entity
  std::vector<Body> bodies;
};

std::shared_ptr<const PoseInput> pose_input(GazeboPoseInput settings);

const PoseSourceType& gazebo_pose_source_type();

}  // namespace sonard::server
