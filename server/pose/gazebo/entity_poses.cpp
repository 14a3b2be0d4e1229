// SPDX-License-Identifier: Apache-2.0
#include "server/pose/gazebo/entity_poses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace sonard::server {
namespace {

pose::Transform compose(const pose::Transform& T_a_b, const pose::Transform& T_b_c) {
  return {T_a_b.position_m + pose::rotate(T_a_b.orientation, T_b_c.position_m),
          pose::normalized(T_a_b.orientation * T_b_c.orientation)};
}

pose::Transform from_render(const render::Pose& pose) {
  const auto& p = pose.position_m;
  const auto& q = pose.orientation;
  return {{p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}};
}

using Found = Result<pose::Transform, std::string>;

Found find(const EntityPoses& poses, const std::string& name) {
  const auto named = [&](const pose::NamedTransform& entity) { return entity.name == name; };
  const auto first = std::find_if(poses.entities.begin(), poses.entities.end(), named);
  if (first == poses.entities.end()) {
    return fmt::format("entity '{}' is not in it", name);
  }
  if (std::find_if(first + 1, poses.entities.end(), named) != poses.entities.end()) {
    return fmt::format("entity '{}' is in it more than once", name);
  }
  pose::Transform transform = first->T_world_body;
  const pose::TransformFault fault = pose::normalize(transform);
  if (fault != pose::TransformFault::none) {
    return fmt::format("entity '{}': {}", name, pose::describe(fault));
  }
  return transform;
}

Found find_in_world(const EntityPoses& poses, const SimulatorEntity& entity) {
  pose::Transform T_world_parent;
  for (const std::string& parent : entity.parents) {
    const Found found = find(poses, parent);
    if (!found) {
      return found;
    }
    T_world_parent = compose(T_world_parent, *found);
  }
  Found found = find(poses, entity.name);
  if (found) {
    *found = compose(T_world_parent, *found);
  }
  return found;
}

bool is_there(const EntityPoses& poses, const std::string& name) {
  return std::any_of(poses.entities.begin(), poses.entities.end(),
                     [&](const pose::NamedTransform& entity) { return entity.name == name; });
}

}  // namespace

EntityMap::EntityMap(const GazeboPoseInput& input)
    : vehicle_(input.vehicle), T_entity_vehicle_(from_render(input.T_entity_vehicle)), bodies_(input.bodies) {
  const auto note = [this](const SimulatorEntity& entity) {
    configured_.insert(entity.name);
    configured_.insert(entity.parents.begin(), entity.parents.end());
  };
  note(vehicle_);
  for (const GazeboPoseInput::Body& body : bodies_) {
    note(body.entity);
  }
}

Result<pose::PoseSample, std::string> EntityMap::map(const EntityPoses& poses) {
  note(poses);
  if (!poses.time_ns) {
    return "its header has no time stamp";
  }
  if (*poses.time_ns < 0 || *poses.time_ns > pose::max_time_ns) {
    return "its time stamp is out of range";
  }
  const Found vehicle = find_in_world(poses, vehicle_);
  if (!vehicle) {
    return vehicle.error();
  }
  pose::PoseSample sample;
  sample.time_ns = *poses.time_ns;
  sample.T_world_vehicle = compose(*vehicle, T_entity_vehicle_);
  for (const GazeboPoseInput::Body& body : bodies_) {
    if (!is_there(poses, body.entity.name)) {
      continue;
    }
    const Found found = find_in_world(poses, body.entity);
    if (!found) {
      return found.error();
    }
    sample.bodies.push_back({body.body, *found});
  }
  return sample;
}

std::vector<std::string> EntityMap::take_ignored() {
  return std::exchange(new_ignored_, {});
}

bool EntityMap::is_configured(std::string_view name) const {
  return configured_.find(name) != configured_.end();
}

void EntityMap::note(const EntityPoses& poses) {
  for (const pose::NamedTransform& entity : poses.entities) {
    if (seen_.size() < max_seen && seen_.insert(entity.name).second && !is_configured(entity.name)) {
      new_ignored_.push_back(entity.name);
    }
  }
}

}  // namespace sonard::server
