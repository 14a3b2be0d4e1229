// SPDX-License-Identifier: Apache-2.0
// Where things of an SDF file are: the frame graph of SDF 1.7 and later (sdformat.org, "Pose frame
// semantics").
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

#include "renderer/pose.hpp"
#include "renderer/scene/sdf_document.hpp"

namespace sonard::render {

/// The scope of a name is the model or world around the element that uses it. Names are those of links,
/// frames, joints and models there; "arm::wrist" is in the model "arm". Keeps what it has worked out: the
/// tree must not change meanwhile.
class SdfFrames {
 public:
  /// Pose of a link, frame, joint or model in its scope.
  /// @throws WorldError "file:line: ..." for a frame that is not there, poses that are relative to each
  /// other, and numbers that are none
  const Pose& T_scope(const SdfElement& element);
  /// Pose of a visual, collision or sensor in the model around its link. @throws WorldError likewise
  Pose T_model(const SdfElement& in_link);

 private:
  using Names = std::map<std::string_view, const SdfElement*>;

  Pose of_frame(const SdfElement& scope, std::string_view name, const SdfElement& named_by);
  Pose worked_out(const SdfElement& element);
  const Names& names_in(const SdfElement& scope);

  std::unordered_map<const SdfElement*, Pose> known_;
  std::unordered_map<const SdfElement*, Names> names_;
  std::unordered_set<const SdfElement*> open_;  ///< being worked out
};

}  // namespace sonard::render
