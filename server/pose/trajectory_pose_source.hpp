// SPDX-License-Identifier: Apache-2.0
// Poses from a trajectory file, played in real time.
#pragma once

#include "protocol/pose/trajectory.hpp"
#include "server/pose/pose_source.hpp"

namespace sonard::server {

/// Starts at start() with the first point. Between the points of the file, poses are interpolated and come
/// 100 times a second, with their twist. At the end, unless it loops, the last pose comes once more, at rest,
/// and then nothing more: it gets stale as any other.
class TrajectoryPoseSource final : public PoseSource {
 public:
  /// @throws pose::TrajectoryError
  TrajectoryPoseSource(boost::asio::io_context& io, TrajectoryInput input, const Clock& clock, PoseSink sink);
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
