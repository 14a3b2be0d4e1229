// SPDX-License-Identifier: Apache-2.0
// Poses over TCP: publishers connect and send varint-delimited messages of pose.proto (docs/poses.md).
#pragma once

#include "server/pose/pose_source.hpp"
#include "server/pose/tcp/input.hpp"

namespace sonard::server {

/// Accepts up to TcpPoseInput::max_clients publishers at a time, each with a buffer for one message. It
/// closes a connection, with one log line that names the peer, if the peer
/// - is not in the allow list, or exceeds max_clients,
/// - sends an invalid length, or one beyond pose::max_message_bytes, or undecodable bytes,
/// - leaves a message unfinished for longer than `message_timeout`.
/// It drops a message with an invalid value (NaN) and keeps the connection. It also keeps a silent
/// connection, such as a paused simulation, until all places are taken. The next publisher then replaces the
/// one that has sent no pose for the longest time, if that is at least most_silence. While `hold` returns
/// true, it reads nothing, so that a publisher soon waits in its own send().
class TcpPoseSource final : public PoseSource {
 public:
  static constexpr std::chrono::seconds most_silence{30};

  /// `hold` may be empty: publishers then never wait.
  TcpPoseSource(boost::asio::io_context& io, const TcpPoseInput& input, const Clock& clock, PoseSink sink,
                PoseHold hold = {}, std::chrono::milliseconds message_timeout = std::chrono::seconds{5});
  ~TcpPoseSource() override;

  void start() override;
  void stop() override;
  std::string description() const override;
  const PoseSourceCounters& counters() const override;
  std::optional<PublisherId> publisher() const override;
  std::string unreadable(TimePoint now) const override;
  /// The listening address, after start().
  Endpoint local_endpoint() const;
  /// Number of connected publishers.
  std::size_t client_count() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
