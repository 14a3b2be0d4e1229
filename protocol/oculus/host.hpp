// SPDX-License-Identifier: Apache-2.0
// The other end of an Oculus: what a client keeps of its stream. No sockets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/common/ping_job.hpp"
#include "protocol/common/shared_bytes.hpp"
#include "protocol/oculus/messages.hpp"

namespace sonard::oculus {

/// A message that a head announces as longer than this is none.
inline constexpr std::size_t most_message_size = std::size_t{16} << 20;

/// A ping and the message that its image views.
struct ReceivedPing {
  TimePoint received{};  ///< when its last byte came
  PingResult result;
  SharedBytes message;
};

/// They only grow.
struct HostStatistics {
  std::uint64_t messages = 0;
  std::uint64_t pings = 0;
  std::uint64_t pings_missed = 0;  ///< by the numbers of those that came
  std::uint64_t bad_messages = 0;
  std::uint64_t dropped_bytes = 0;  ///< that were part of no message
  std::uint64_t dummies = 0;
};

/// Not thread-safe. Belongs to one head, through any number of connections.
class Host {
 public:
  /// A stream has begun: what came of the one before is forgotten.
  void connected();
  /// Bytes of the stream, in pieces of any size.
  void receive(TimePoint now, std::span<const std::uint8_t> bytes);

  /// Those that have come since the last call.
  std::vector<ReceivedPing> take_pings();
  /// The text of log messages, likewise.
  std::vector<std::string> take_logs();
  const HostStatistics& statistics() const { return statistics_; }

 private:
  /// Bytes of the message in front, after dropping those that begin none; nullopt: it is not whole.
  std::optional<std::size_t> front_size();
  void take(TimePoint now, std::vector<std::uint8_t> message);

  std::vector<std::uint8_t> bytes_;
  std::vector<ReceivedPing> pings_;
  std::vector<std::string> logs_;
  std::optional<std::uint32_t> last_ping_id_;  ///< of this connection
  HostStatistics statistics_;
};

}  // namespace sonard::oculus
