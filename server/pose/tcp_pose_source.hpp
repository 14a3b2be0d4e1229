// SPDX-License-Identifier: Apache-2.0
// Poses by TCP: publishers connect and send varint-delimited messages of pose.proto (docs/poses.md).
#pragma once

#include "server/pose/pose_source.hpp"

namespace sonard::server {

/// Up to TcpPoseInput::max_clients publishers at a time, each with a buffer for one message. A connection is
/// closed, with one log line that names the peer, when the peer
/// - is not in the allow list, or one too many,
/// - sends a length that is none or beyond pose::max_message_bytes, or bytes that are no pose message,
/// - leaves a message unfinished for longer than `message_timeout`.
/// A message with a value that means nothing (NaN) is dropped, and the connection stays. So does one on which
/// nothing comes: a paused simulation keeps its connection, until all places are taken. Then the next
/// publisher takes the place of the one that sent no pose for longest, and for most_silence at least. While
/// `hold` says so nothing is read, so that a publisher waits in its own send() before long.
class TcpPoseSource final : public PoseSource {
 public:
  static constexpr std::chrono::seconds most_silence{30};

  /// `hold` may be empty: publishers do not wait then.
  TcpPoseSource(boost::asio::io_context& io, const TcpPoseInput& input, const Clock& clock, PoseSink sink,
                PoseHold hold = {}, std::chrono::milliseconds message_timeout = std::chrono::seconds{5});
  ~TcpPoseSource() override;

  void start() override;
  void stop() override;
  std::string description() const override;
  const PoseSourceCounters& counters() const override;
  std::string received() const override;
  /// Where it listens, once started.
  Endpoint local_endpoint() const;
  /// Publishers connected now.
  std::size_t client_count() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
