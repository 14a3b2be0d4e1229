// SPDX-License-Identifier: Apache-2.0
// Poses by MAVLink over UDP (docs/simulators/ardusub.md).
#pragma once

#include "server/pose/pose_source.hpp"

namespace sonard::server {

/// Listens only: it sends no heartbeat and asks for no message. A datagram may hold any number of frames, of
/// either version; what is no frame, and what is of another vehicle, is counted and dropped. Nothing that a
/// peer repeats fills the log: troubles are told the 1st, 2nd, 4th, 8th ... time, senders that are ignored
/// once each. A vehicle that sends for `patience` without giving a pose is logged once, with what is
/// missing.
class MavlinkPoseSource final : public PoseSource {
 public:
  MavlinkPoseSource(boost::asio::io_context& io, MavlinkPoseInput input, const Clock& clock, PoseSink sink);
  ~MavlinkPoseSource() override;

  void start() override;
  void stop() override;
  std::string description() const override;
  const PoseSourceCounters& counters() const override;
  std::string details() const override;
  std::string received() const override;
  std::string stamp_name() const override { return "time_boot_ms (of ODOMETRY: time_usec)"; }
  std::string remark() const override;
  std::string silence_hint() const override;
  /// Where it listens, once started.
  Endpoint local_endpoint() const;

  static constexpr std::chrono::seconds patience{5};

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
