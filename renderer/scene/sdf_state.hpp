// SPDX-License-Identifier: Apache-2.0
// The <state> of a world that Gazebo Classic saved: where its models were then.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "renderer/pose.hpp"
#include "renderer/scene/sdf_tree.hpp"

namespace sonard::render {

/// Follows what Gazebo Classic 11 does when it loads a world (its World::SetState, Model::SetState and
/// Link::SetScale): insertions become models of the world; poses of models, links and nested models are in
/// the world frame; a link that is not listed moves with its model; a scale multiplies the sizes of boxes,
/// spheres, cylinders and meshes of the links, and no distance between them; deletions come last. Of several
/// <state>, the first counts. A model or link that is listed without a pose stands in the origin of the
/// world.
class SavedState {
 public:
  /// Changes `world`: adds, scales and removes models. Names that the world does not have go to `warnings`.
  /// @throws WorldError "file:line: ..." for numbers that are none
  void apply(SdfElement& world, std::vector<std::string>& warnings);

  /// Null: the state does not say where this model or link is.
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
