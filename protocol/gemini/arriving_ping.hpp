// SPDX-License-Identifier: Apache-2.0
// A ping that is arriving at a client, and the requests for its lost parts. Source:
// protocol/gemini/README.md 7.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "protocol/common/ping_job.hpp"
#include "protocol/gemini/messages.hpp"
#include "protocol/gemini/ping_assembly.hpp"
#include "protocol/gemini/response_time.hpp"

namespace sonard::gemini {

/// `patience` for the first try, twice as long for each further one.
constexpr std::chrono::nanoseconds doubled(std::chrono::nanoseconds patience, int times,
                                           std::chrono::nanoseconds most) {
  return std::min(patience * (1 << std::clamp(times, 0, 10)), most);
}

/// Retry requests by kind, in datagrams. A request sent in two copies counts twice.
struct RetryCounters {
  std::uint64_t head = 0, lines = 0, tail = 0;

  std::uint64_t total() const { return head + lines + tail; }
  void count(RetryKind kind) { ++(kind == RetryKind::head ? head : kind == RetryKind::lines ? lines : tail); }
};

/// Requests are few in the first pass, because a head serves them only after its tail, and repeated in rounds
/// after it. `answers` estimates the time from a retry request to the first resent datagram.
class ArrivingPing {
 public:
  static constexpr ResponseTime::Limits answer_limits{
      std::chrono::milliseconds{3}, std::chrono::milliseconds{2}, std::chrono::milliseconds{25}};

  /// @param id low byte of the ping ID
  /// @param now when its first datagram arrived
  /// @param continuous whether the head begins its next ping by itself
  /// @param requested false: it answers no configuration of the client, which only watches until it ends
  ArrivingPing(std::uint8_t id, TimePoint now, bool continuous, bool requested)
      : assembly_(id),
        continuous_(continuous),
        requested_(requested),
        first_datagram_(now),
        last_arrival_(now),
        progress_(now),
        marked_at_(now) {}

  PingAssembly& assembly() { return assembly_; }
  const PingAssembly& assembly() const { return assembly_; }
  bool requested() const { return requested_; }
  bool has_tail() const { return has_tail_; }
  TimePoint first_datagram() const { return first_datagram_; }
  int lines_repaired() const { return lines_repaired_; }
  const RetryCounters& retries() const { return retries_; }
  /// False if `head` belongs to another ping with an equal ID: then the transmit times differ.
  bool may_have(const PingHead& head) const {
    return !assembly_.head() || assembly_.head()->transmit_time_us == head.transmit_time_us;
  }

  /// Requires may_have(head) and is_receivable(head).
  void on_head(TimePoint now, const PingHead& head, ResponseTime& answers);
  PingAssembly::Added on_line(TimePoint now, const PingLine& line, ResponseTime& answers);
  void on_tail(TimePoint now, const PingTail& tail, ResponseTime& answers);

  /// It turned out to answer no configuration of the client.
  void disown() { requested_ = false; }
  /// The head has begun its next ping, so it cannot resend parts of this one any more.
  void superseded() { pass_over_ = true; }

  /// When to look at is_over(), and to call ask_again() if it is not.
  TimePoint due(const ResponseTime& answers) const;
  /// Whether nothing more is worth waiting for.
  bool is_over(TimePoint now) const;
  void ask_again(TimePoint now);
  /// The requests to send, in order. Each call empties the list.
  std::vector<RetryRequest> take_requests() { return std::exchange(requests_, {}); }

 private:
  void on_answer(TimePoint now, ResponseTime& answers);
  void end_first_pass();
  void follow_first_pass(TimePoint now, int number);
  void ask_unasked(int end);
  void ask(RetryKind kind, int copies, LineRange range = {0, 1});
  std::chrono::nanoseconds stream_patience() const;

  PingAssembly assembly_;
  bool continuous_;
  bool requested_;
  TimePoint first_datagram_;
  TimePoint last_arrival_;  ///< of the last datagram of this ping, or of the last round of requests
  TimePoint progress_;      ///< of the last datagram with new content
  bool pass_over_ = false;  ///< the first pass is over: the head now answers requests
  bool has_tail_ = false;
  bool head_asked_ = false;
  bool asked_ahead_ = false;
  int highest_ = -1;     ///< highest line number of the first pass
  TimePoint marked_at_;  ///< when `marked_` was the highest line
  int marked_ = 0;       ///< missing lines below it are lost, not late
  int asked_to_ = 0;     ///< missing lines below it have been requested
  int fruitless_ = 0;    ///< rounds of requests without an answer
  int lines_repaired_ = 0;
  std::optional<TimePoint> asked_at_;  ///< first round since the last answer
  RetryCounters retries_;
  std::vector<RetryRequest> requests_;
};

}  // namespace sonard::gemini
