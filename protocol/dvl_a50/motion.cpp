// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/motion.hpp"

#include "protocol/dvl_a50/beams.hpp"

namespace sonard::dvl_a50 {
namespace {

/// Of a vector in the frame of the head.
Vector of_device(const Vector& of_head) {
  return {of_head[2], -of_head[1], of_head[0]};
}

}  // namespace

Motion device_motion(const SensorReadings& readings) {
  const auto& [w, x, y, z] = readings.orientation_wxyz;
  const Matrix R_world_head{{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                             {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                             {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
  Motion motion{of_device(readings.velocity_mps), {}};
  for (std::size_t row = 0; row < 3; ++row) {
    motion.axes[row] = of_device(R_world_head[row]);
  }
  return motion;
}

Motion vehicle_motion(const Motion& of_device, double rad) {
  Motion motion{to_vehicle(of_device.velocity_mps, rad), {}};
  for (std::size_t row = 0; row < 3; ++row) {
    motion.axes[row] = to_vehicle(of_device.axes[row], rad);
  }
  return motion;
}

Vector from_world(const Matrix& axes, const Vector& of_world) {
  Vector result{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t row = 0; row < 3; ++row) {
      result[i] += axes[row][i] * of_world[row];
    }
  }
  return result;
}

}  // namespace sonard::dvl_a50
