// SPDX-License-Identifier: Apache-2.0
// An Oculus client: collects messages from the head's stream. Uses no sockets.
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

/// Maximum size of a message from a head. A longer one is not a message.
inline constexpr std::size_t most_message_size = std::size_t{16} << 20;

/// A ping and the message that its image views.
struct ReceivedPing {
  TimePoint received{};  ///< arrival of its last byte
  PingResult result;
  SharedBytes message;
};

/// Counters since construction. They only grow.
struct ClientStatistics {
  std::uint64_t messages = 0;
  std::uint64_t pings = 0;
  std::uint64_t pings_missed = 0;  ///< gaps in the numbers of received pings
  std::uint64_t bad_messages = 0;
  std::uint64_t dropped_bytes = 0;  ///< not part of a message
  std::uint64_t dummies = 0;
};

/// Not thread-safe. For one head, over any number of connections.
class Client {
 public:
  /// Begins a new stream and drops unfinished messages of the last one.
  void connected();
  /// Handles bytes of the stream, in parts of any size.
  void receive(TimePoint now, std::span<const std::uint8_t> bytes);

  /// Pings received since the last call.
  std::vector<ReceivedPing> take_pings();
  /// Texts of the log messages received since the last call.
  std::vector<std::string> take_logs();
  const ClientStatistics& statistics() const { return statistics_; }

 private:
  /// Size of the message in front, after dropping bytes before it; nullopt if it is incomplete.
  std::optional<std::size_t> front_size();
  void take(TimePoint now, std::vector<std::uint8_t> message);

  std::vector<std::uint8_t> bytes_;
  std::vector<ReceivedPing> pings_;
  std::vector<std::string> logs_;
  std::optional<std::uint32_t> last_ping_id_;  ///< in this connection
  ClientStatistics statistics_;
};

}  // namespace sonard::oculus
