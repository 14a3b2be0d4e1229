// SPDX-License-Identifier: Apache-2.0
// Poses of Gazebo, by Ignition Transport (docs/simulators/gazebo.md).
#pragma once

#include "server/pose/pose_source.hpp"

namespace sonard::server {

/// Takes Pose_V and Pose messages of one topic, of the packages ignition.msgs and gz.msgs alike. The time of
/// a pose is that of the header, simulated time. A message that cannot be used is counted and dropped: one of
/// another type or with bytes that are none as `malformed`, one that EntityMap refuses as `bad_value`, one
/// that comes while max_waiting others wait as `refused`. The 1st, 2nd, 4th, 8th ... of each is logged.
///
/// Messages arrive on a thread of the transport, which takes the time and hands the bytes to the I/O thread.
class IgnitionPoseSource final : public PoseSource {
 public:
  IgnitionPoseSource(boost::asio::io_context& io, IgnitionPoseInput input, const Clock& clock, PoseSink sink);
  ~IgnitionPoseSource() override;

  void start() override;
  void stop() override;
  std::string description() const override;
  const PoseSourceCounters& counters() const override;
  std::vector<std::string> entities() const override;
  std::string stamp_name() const override { return "header.stamp"; }
  std::string silence_hint() const override;

  static constexpr int max_waiting = 16;

 private:
  struct Impl;
  struct Subscription;
  std::shared_ptr<Impl> impl_;
  std::unique_ptr<Subscription> subscription_;
};

}  // namespace sonard::server
