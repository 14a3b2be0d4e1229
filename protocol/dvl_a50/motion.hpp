// SPDX-License-Identifier: Apache-2.0
// The motion of the device, from the readings of its head.
//
// The head's x axis is the z axis of the device: it looks down. Its y axis is to port, its z axis forward. So
// the four beams are the corners of a grid of directions about the head's x axis.
#pragma once

#include "protocol/common/ping_job.hpp"
#include "protocol/dvl_a50/messages.hpp"

namespace sonard::dvl_a50 {

/// In the frame of the device (x forward, y right, z down) or of the vehicle.
struct Motion {
  Vector velocity_mps{};
  /// Columns: the axes of that frame in the world (x east, y north, z up).
  Matrix axes{{{0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, -1.0}}};
};

Motion device_motion(const SensorReadings& readings);
/// The same for a vehicle from whose forward axis the device is turned clockwise by `rad`.
Motion vehicle_motion(const Motion& of_device, double rad);
/// A vector of the world in a frame.
Vector from_world(const Matrix& axes, const Vector& of_world);

}  // namespace sonard::dvl_a50
