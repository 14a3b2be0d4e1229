// SPDX-License-Identifier: Apache-2.0
// Poses from MAVLink over UDP (docs/simulators/ardusub.md).
#pragma once

#include "server/pose/mavlink/input.hpp"
#include "server/pose/pose_source.hpp"

namespace sonard::server {

/// Only listens: it sends no heartbeat and requests no message. A datagram may hold any number of frames of
/// either version. Broken frames and frames of other vehicles are counted and dropped. Logging is limited:
/// each error is logged the 1st, 2nd, 4th, 8th ... time, each ignored sender once. If a vehicle sends for
/// `patience` without giving a pose, the missing messages are logged once.
class MavlinkPoseSource final : public PoseSource {
 public:
  MavlinkPoseSource(boost::asio::io_context& io, MavlinkPoseInput input, const Clock& clock, PoseSink sink);
  ~MavlinkPoseSource() override;

  void start() override;
  void stop() override;
  std::string description() const override;
  const PoseSourceCounters& counters() const override;
  std::string details() const override;
  std::optional<PublisherId> publisher() const override;
  StampField stamp_field() const override;
  std::string remark() const override;
  std::string unreadable(TimePoint now) const override;
  std::string silence_hint() const override;
  /// The listening address, after start().
  Endpoint local_endpoint() const;

  static constexpr std::chrono::seconds patience{5};

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
