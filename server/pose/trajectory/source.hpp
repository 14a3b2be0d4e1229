// SPDX-License-Identifier: Apache-2.0
// Poses from a trajectory file, played back at TrajectoryInput::speed.
#pragma once

#include "protocol/pose/trajectory.hpp"
#include "server/pose/pose_source.hpp"
#include "server/pose/trajectory/input.hpp"

namespace sonard::server {

/// Starts at start() with the first point. Sends interpolated poses with their twist 100 times a second. At
/// the end, unless it loops, it sends the last pose once more, at rest, and then stops: the pose becomes
/// stale like any other.
class TrajectoryPoseSource final : public PoseSource {
 public:
  /// @param trajectory of the input's file
  TrajectoryPoseSource(boost::asio::io_context& io, pose::Trajectory trajectory, TrajectoryInput input,
                       const Clock& clock, PoseSink sink);
  ~TrajectoryPoseSource() override;

  void start() override;
  void stop() override;
  std::string description() const override;
  const PoseSourceCounters& counters() const override;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
