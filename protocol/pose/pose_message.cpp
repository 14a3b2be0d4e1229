// SPDX-License-Identifier: Apache-2.0
#include "protocol/pose/pose_message.hpp"

namespace sonard::pose {

void write(const Transform& transform, Pose& message) {
  Vector3& position = *message.mutable_position_m();
  position.set_x(transform.position_m.x);
  position.set_y(transform.position_m.y);
  position.set_z(transform.position_m.z);
  Quaternion& q = *message.mutable_orientation();
  q.set_w(transform.orientation.w);
  q.set_x(transform.orientation.x);
  q.set_y(transform.orientation.y);
  q.set_z(transform.orientation.z);
}

TransformFault read(const Pose& message, Transform& transform) {
  const Vector3& position = message.position_m();
  const Quaternion& q = message.orientation();
  transform = {{position.x(), position.y(), position.z()}, {q.w(), q.x(), q.y(), q.z()}};
  return normalize(transform);
}

}  // namespace sonard::pose
