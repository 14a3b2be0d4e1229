// SPDX-License-Identifier: Apache-2.0
// Converts poses of the pose protocol to the renderer's.
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
