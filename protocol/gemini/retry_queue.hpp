// SPDX-License-Identifier: Apache-2.0
// Queue of the client's retry requests for the last ping (protocol/gemini/README.md 7.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "protocol/gemini/messages.hpp"

namespace sonard::gemini {

/// Returns requests in the order of their arrival, datagram by datagram. Memory and resends are bounded, so
/// that a flood of requests can neither grow the head nor make it send for ever. Both libraries request a
/// line at most six times; each line is resent at most `max_resends` times.
class RetryQueue {
 public:
  static constexpr std::size_t max_ranges = 4096;
  static constexpr std::uint8_t max_resends = 16;

  /// One datagram to send again.
  struct Resend {
    RetryKind kind = RetryKind::tail;
    int line = 0;  ///< for RetryKind::lines

    bool operator==(const Resend&) const = default;
  };

  /// Clears the queue for a new ping of `line_count` lines.
  void reset(int line_count);

  /// Adds a request. A request that equals, overlaps or continues the last queued one is merged with it.
  /// False if the request is dropped: the queue is full, the line does not exist, or the kind is unknown.
  bool push(const RetryRequest& request);

  /// Removes and returns the next datagram to send; nullopt if the queue is empty. Skips lines that were
  /// resent `max_resends` times.
  std::optional<Resend> pop();

  bool empty() const { return ranges_.empty(); }
  /// Number of queued requests after merging.
  std::size_t size() const { return ranges_.size(); }
  /// Number of queued datagrams, at most `limit`; at least 1 unless empty.
  int pending(int limit) const;

 private:
  struct Range {
    RetryKind kind = RetryKind::tail;
    int first = 0;
    int count = 1;
  };

  bool push_lines(int first, int count);

  std::deque<Range> ranges_;
  std::vector<std::uint8_t> resends_;  ///< per line
};

}  // namespace sonard::gemini
