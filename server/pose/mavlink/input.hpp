// SPDX-License-Identifier: Apache-2.0
// The section `poses.mavlink`: telemetry of a MAVLink vehicle.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "renderer/pose.hpp"
#include "renderer/scene/geographic_frame.hpp"
#include "server/net/addresses.hpp"
#include "server/pose/pose_input.hpp"

namespace sonard::server {

/// The messages of a MAVLink vehicle that give its position.
enum class MavlinkMessages {
  automatic,       ///< ODOMETRY if it arrives, else the others
  odometry,        ///< ODOMETRY
  local_position,  ///< LOCAL_POSITION_NED with ATTITUDE or ATTITUDE_QUATERNION
  global_position  ///< GLOBAL_POSITION_INT with ATTITUDE or ATTITUDE_QUATERNION
};

/// A UDP socket that listens to a MAVLink vehicle (docs/simulators/ardusub.md).
struct MavlinkPoseInput {
  Endpoint bind;
  AllowList allow;
  std::uint8_t system_id = 1;     ///< the vehicle, 1..255
  std::uint8_t component_id = 1;  ///< component whose messages are used, 1..255; 1: the autopilot
  MavlinkMessages messages = MavlinkMessages::automatic;
  render::Pose T_world_local;  ///< origin of the vehicle's positions, in axes east, north, up
  /// The world's place on Earth, for global_position (PoseInput::in_world() sets it).
  std::optional<render::GeographicOrigin> world_origin;
};

std::shared_ptr<const PoseInput> pose_input(MavlinkPoseInput settings);

const PoseSourceType& mavlink_pose_source_type();

}  // namespace sonard::server
