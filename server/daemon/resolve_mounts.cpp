// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/resolve_mounts.hpp"

#include <cstddef>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "server/heads/head_type.hpp"
#include "server/pose/pose_input.hpp"

namespace sonard::server {
namespace {

/// Sonars whose path is or ends with the name; all sonars for "".
std::vector<const render::WorldSonar*> sonars_named(const render::World& world, const std::string& name) {
  std::vector<const render::WorldSonar*> found;
  for (const render::WorldSonar& sonar : world.sonars) {
    if (name.empty() || sonar.path == name || sonar.path.ends_with("::" + name)) {
      found.push_back(&sonar);
    }
  }
  return found;
}

std::string paths(const std::vector<const render::WorldSonar*>& sonars) {
  std::vector<std::string> names;
  for (const render::WorldSonar* sonar : sonars) {
    names.push_back(sonar->path);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

class MountResolver {
 public:
  MountResolver(DaemonConfig& config, const render::World& world) : config_(config), world_(world) {}

  std::vector<ConfigProblem> take() {
    if (!config_.world.vehicle_model.empty() && world_.find_body(config_.world.vehicle_model) == nullptr) {
      problem("world.vehicle_model", fmt::format("the world has no model '{}'", config_.world.vehicle_model));
    }
    for (std::size_t i = 0; i < config_.heads.size(); ++i) {
      mount(i);
    }
    for (std::size_t i = 0; i < config_.heads.size(); ++i) {
      if (config_.heads[i].hides_vehicle && config_.world.vehicle_model.empty()) {
        problem(
            fmt::format("heads[{}].hides_vehicle", i),
            "the world has no model of the vehicle (expected world.vehicle_model, or a mount from_world)");
      }
    }
    resolve_inputs();
    return std::move(problems_);
  }

 private:
  void problem(std::string key, std::string message) {
    problems_.push_back({{}, std::move(key), std::move(message)});
  }

  void mount(std::size_t index) {
    HeadConfig& head = config_.heads[index];
    if (head.mount_from_world.empty()) {
      return;
    }
    const std::string key = fmt::format("heads[{}].mount.from_world", index);
    const auto found = sonars_named(world_, head.mount_from_world);
    if (found.empty()) {
      problem(key, fmt::format("the world has no sonar '{}' (expected {})", head.mount_from_world,
                               world_.sonars.empty()
                                   ? "a <sensor type=\"custom\" sonard:type=\"...\"> in the world"
                                   : "one of " + paths(sonars_named(world_, ""))));
    } else if (found.size() > 1) {
      problem(key, fmt::format("'{}' is the name of several sonars of the world (expected one of {})",
                               head.mount_from_world, paths(found)));
    } else if (found.front()->type != head.type->name()) {
      problem(key, fmt::format("{} has type {} in the world (expected {}, the type of this head)",
                               found.front()->path, found.front()->type, head.type->name()));
    } else {
      head.T_vehicle_sonar = found.front()->T_body_sonar;
      carry(key, *found.front());
    }
  }

  void carry(const std::string& key, const render::WorldSonar& sonar) {
    if (config_.world.vehicle_model.empty()) {
      config_.world.vehicle_model = sonar.body;
    } else if (config_.world.vehicle_model != sonar.body) {
      problem(key, fmt::format("{} is on model '{}', but the vehicle is '{}' (expected one vehicle)",
                               sonar.path, sonar.body, config_.world.vehicle_model));
    }
  }

  void resolve_inputs() {
    const WorldOfPoses world{config_.world.vehicle_model, world_.origin};
    for (std::shared_ptr<const PoseInput>& input : config_.poses.inputs) {
      if (auto resolved = input->in_world(world, problems_)) {
        input = std::move(resolved);
      }
    }
  }

  DaemonConfig& config_;
  const render::World& world_;
  std::vector<ConfigProblem> problems_;
};

}  // namespace

std::vector<ConfigProblem> resolve_mounts(DaemonConfig& config, const render::World& world) {
  return MountResolver(config, world).take();
}

}  // namespace sonard::server
