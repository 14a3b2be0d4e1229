// SPDX-License-Identifier: Apache-2.0
// Poses of the pose protocol as the renderer has them.
#pragma once

#include "protocol/pose/transform.hpp"
#include "renderer/pose.hpp"

namespace sonard::server {

inline render::Pose to_render(const pose::Transform& transform) {
  const pose::Vec3& p = transform.position_m;
  const pose::Quat& q = transform.orientation;
  return {glm::dvec3(p.x, p.y, p.z), glm::dquat(q.w, q.x, q.y, q.z)};
}

}  // namespace sonard::server
