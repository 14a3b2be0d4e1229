// SPDX-License-Identifier: Apache-2.0
// The section `poses.trajectory`: a trajectory file.
#pragma once

#include <filesystem>
#include <memory>

#include "protocol/pose/pose_codec.hpp"
#include "server/pose/pose_input.hpp"

namespace sonard::server {

/// A trajectory file, played in real time from the start of the daemon.
struct TrajectoryInput {
  std::filesystem::path file;  ///< CSV or TUM, recognised by its content (docs/poses.md)
  bool loop = false;           ///< false: the last pose stays the newest one
  double speed = 1.0;          ///< 2: twice as fast as recorded; > 0
  pose::Axes axes = pose::Axes::enu_flu;
};

std::shared_ptr<const PoseInput> pose_input(TrajectoryInput settings);

const PoseSourceType& trajectory_pose_source_type();

}  // namespace sonard::server
