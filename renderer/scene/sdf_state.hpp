// SPDX-License-Identifier: Apache-2.0
// The <state> that Gazebo Classic saves in a world: the poses of its models at that time.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "renderer/pose.hpp"
#include "renderer/scene/sdf_tree.hpp"

namespace sonard::render {

/// Follows Gazebo Classic 11's loading of a world (World::SetState, Model::SetState and Link::SetScale).
/// Insertions become models of the world. Poses of models, links and nested models are in the world frame. A
/// link that is not listed moves with its model. A scale multiplies the sizes of boxes, spheres, cylinders
/// and meshes in the links, but no distances between them. Deletions come last. The first <state> counts. A
/// model or link that is listed without a pose is at the origin of the world.
class SavedState {
 public:
  /// Adds, scales and removes models of `world`. Names that the world does not have add to `warnings`.
  /// @throws WorldError "file:line: ..." for invalid numbers
  void apply(SdfElement& world, std::vector<std::string>& warnings);

  /// nullptr if the state has no pose for this model or link.
  const Pose* T_world(const SdfElement& model_or_link) const;

 private:
  void insert_models(SdfElement& state, SdfElement& world);
  void set_models(const SdfElement& states, SdfElement& around, const std::string& path);
  void set_model(const SdfElement& state, SdfElement& model, const std::string& path);
  void remove_models(const SdfElement& state, SdfElement& world);

  std::unordered_map<const SdfElement*, Pose> T_world_;
  std::vector<std::string> unknown_;  ///< "cart::wheel"
};

}  // namespace sonard::render
