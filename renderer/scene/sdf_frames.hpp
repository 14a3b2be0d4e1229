// SPDX-License-Identifier: Apache-2.0
// Poses in an SDF file, by the frame graph of SDF 1.7 and later (sdformat.org, "Pose frame semantics").
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

#include "renderer/pose.hpp"
#include "renderer/scene/sdf_tree.hpp"

namespace sonard::render {

/// Reads a <pose>: x, y, z and roll, pitch, yaw about fixed axes, or a quaternion x, y, z, w; identity if
/// `pose` is null or empty.
/// @throws WorldError "file:line: ..."
Pose read_pose(const SdfElement* pose);

/// The scope of a name is the model or world around the element that uses it. It holds the names of links,
/// frames, joints and models there. "arm::wrist" is the element with this whole name, as in flattened models,
/// else "wrist" in the model "arm". Results are cached, so the tree must not change.
class SdfFrames {
 public:
  /// Pose of a link, frame, joint or model in its scope.
  /// @throws WorldError "file:line: ..." for a missing frame, poses that are relative to each other, and
  /// invalid numbers; MissingFile for a frame of a model with a missing file
  const Pose& T_scope(const SdfElement& element);
  /// Pose of a visual, collision or sensor in the model around its link. @throws as T_scope()
  Pose T_model(const SdfElement& in_link);
  /// Pose of the element called `name` in the model or world `scope`. @throws as T_scope(), with the place of
  /// `named_by`
  Pose of_frame(const SdfElement& scope, std::string_view name, const SdfElement& named_by);

 private:
  using Names = std::map<std::string_view, const SdfElement*>;

  std::optional<Pose> find(const SdfElement& scope, std::string_view name);
  Pose worked_out(const SdfElement& element);
  const Names& names_in(const SdfElement& scope);

  std::unordered_map<const SdfElement*, Pose> known_;
  std::unordered_map<const SdfElement*, Names> names_;
  std::unordered_set<const SdfElement*> open_;  ///< in progress, to find circles
};

}  // namespace sonard::render
