// SPDX-License-Identifier: Apache-2.0
// Poses over UDP: one message of pose.proto per datagram (docs/poses.md).
#pragma once

#include "server/pose/pose_source.hpp"
#include "server/pose/udp/input.hpp"

namespace sonard::server {

/// Undecodable datagrams, and datagrams from peers that are not allowed, are counted and dropped. The 1st,
/// 2nd, 4th, 8th ... is logged with its peer, so that a flood cannot fill the log.
class UdpPoseSource final : public PoseSource {
 public:
  UdpPoseSource(boost::asio::io_context& io, const UdpPoseInput& input, const Clock& clock, PoseSink sink);
  ~UdpPoseSource() override;

  void start() override;
  void stop() override;
  std::string description() const override;
  const PoseSourceCounters& counters() const override;
  std::optional<PublisherId> publisher() const override;
  std::string unreadable(TimePoint now) const override;
  /// The listening address, after start().
  Endpoint local_endpoint() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
