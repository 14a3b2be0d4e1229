// SPDX-License-Identifier: Apache-2.0
// Poses from Gazebo through Ignition Transport (docs/simulators/gazebo.md).
#pragma once

#include "server/pose/gazebo/input.hpp"
#include "server/pose/pose_source.hpp"

namespace sonard::server {

/// Accepts Pose_V and Pose messages on one topic, from the packages ignition.msgs and gz.msgs. The time of a
/// pose is the simulated time in the header. Unusable messages are counted and dropped. `malformed` counts
/// other types and undecodable bytes, `bad_value` messages that EntityMap rejects, `refused` messages that
/// arrive while max_waiting others wait. The 1st, 2nd, 4th, 8th ... of each is logged.
///
/// Messages arrive on a thread of the transport, which reads the time and posts the bytes to the I/O thread.
class GazeboPoseSource final : public PoseSource {
 public:
  GazeboPoseSource(boost::asio::io_context& io, GazeboPoseInput input, const Clock& clock, PoseSink sink);
  ~GazeboPoseSource() override;

  void start() override;
  void stop() override;
  std::string description() const override;
  const PoseSourceCounters& counters() const override;
  std::vector<std::string> entities() const override;
  StampField stamp_field() const override { return {"header.stamp", "seconds and nanoseconds", 1e-9}; }
  std::string unreadable(TimePoint now) const override;
  std::string silence_hint() const override;

  static constexpr int max_waiting = 16;

 private:
  struct Impl;
  struct Subscription;
  std::shared_ptr<Impl> impl_;
  std::unique_ptr<Subscription> subscription_;
};

}  // namespace sonard::server
