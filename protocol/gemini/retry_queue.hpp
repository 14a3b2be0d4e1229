// SPDX-License-Identifier: Apache-2.0
// What the topside wants to have again of the last ping (docs/protocols/gemini.md 7.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "protocol/gemini/messages.hpp"

namespace sonard::gemini {

/// Requests in the order of their arrival, handed out datagram by datagram. Bounded in memory and in effect:
/// a peer that floods requests can make the head neither grow nor send for ever. Both libraries ask for a
/// line at most six times; here each line goes out again at most `max_resends` times.
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

  /// Forgets everything; the ping that requests are about from now on has `line_count` lines.
  void reset(int line_count);

  /// False when the request is not kept: the queue is full, or the ping has no such thing. A request that
  /// says the same as the last one waiting, or begins where it ends, joins it.
  bool push(const RetryRequest& request);

  /// The next datagram to send; nullopt when there is none. Lines that went out too often are passed over.
  std::optional<Resend> pop();

  bool empty() const { return ranges_.empty(); }
  /// Requests waiting, after joining.
  std::size_t size() const { return ranges_.size(); }
  /// Datagrams waiting, at least 1 unless empty; no more than `limit` is looked at.
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
