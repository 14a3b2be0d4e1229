// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/arriving_ping.hpp"

#include <cstddef>

namespace sonard::gemini {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

/// In continuous mode a head delays its next ping only while requests arrived within the last 10 ms (7.3).
/// Two datagrams every 2 ms fail to keep this up once in 1e13 times on a link that loses 5 %. On a slow link
/// the answer takes longer than the 10 ms, so the client sends several requests.
constexpr nanoseconds answer_patience_continuous = milliseconds{2};
constexpr nanoseconds patience_most = milliseconds{100};
constexpr int fruitless_rounds_at_full_speed = 4;

/// A line that arrives later than this after a higher one counts as lost. The head answers only after the
/// tail, so an earlier request would gain nothing.
constexpr nanoseconds reorder_patience = milliseconds{1};
/// Silence in the first pass that means its end was lost, in addition to the acoustic time of a burst, for
/// which a head waits before it sends one. A false alarm costs a resent tail. Real clients wait similarly
/// long (7.1, 7.2). Near the end early ones repeat requests after 5 ms, later ones if the last 35 lines come
/// slower than one per millisecond. Before, they give a ping 400 ms.
constexpr nanoseconds patience_at_the_end = milliseconds{8};
constexpr nanoseconds patience_before_the_end = milliseconds{400};
constexpr int last_lines = 35;
constexpr int burst_lines = 32;
/// The tail follows the last line immediately, and the first line follows the head immediately.
constexpr nanoseconds neighbour_patience = milliseconds{2};
/// This close to its end, an incomplete ping gets a precautionary request in continuous mode. Without a
/// recent request the head begins its next ping at once, and the last lines may be lost along with the tail.
constexpr int precaution_lines = 8;
/// Rounds of requests if only the tail is missing, which the image does not need.
constexpr int rounds_for_the_tail_alone = 8;
/// If nothing new arrives for this long, the rest of the ping will not arrive.
constexpr nanoseconds give_up_after = seconds{1};
/// An unrequested ping has ended if no datagram of it arrives for this long.
constexpr nanoseconds unrequested_patience = milliseconds{100};

constexpr int copies_of_a_repeated_request = 2;
constexpr int few_lines = 16;  ///< up to this number, second copies of requests cost the link little
constexpr std::size_t most_ranges_a_round = 256;
constexpr std::uint16_t resent_head = 0x0100;  // bit of PingHead::ping_id (6.3)

}  // namespace

// ---- Datagrams

void ArrivingPing::on_head(TimePoint now, const PingHead& head, ResponseTime& answers) {
  last_arrival_ = now;
  const bool is_first = !assembly_.head();
  if (is_first) {
    assembly_.set_head(head);
    progress_ = now;
  }
  if ((head.ping_id & resent_head) != 0) {
    on_answer(now, answers);
  }
  if (is_first && pass_over_ && requested_) {
    ask_unasked(assembly_.line_count());
  }
}

PingAssembly::Added ArrivingPing::on_line(TimePoint now, const PingLine& line, ResponseTime& answers) {
  last_arrival_ = now;
  const auto added = assembly_.add_line(line);
  if (added == PingAssembly::Added::unusable) {
    return added;
  }
  if (added == PingAssembly::Added::fresh) {
    progress_ = now;
    lines_repaired_ += line.resent() ? 1 : 0;
  }
  if (line.resent()) {
    on_answer(now, answers);
  } else if (!pass_over_) {
    follow_first_pass(now, line.line_number());
  }
  return added;
}

void ArrivingPing::on_tail(TimePoint now, const PingTail& tail, ResponseTime& answers) {
  last_arrival_ = now;
  if (!std::exchange(has_tail_, true)) {
    progress_ = now;
  }
  if (tail.resent()) {
    on_answer(now, answers);
  } else {
    end_first_pass();
  }
}

/// A head serves requests only after the tail, so any resent datagram ends the first pass.
void ArrivingPing::on_answer(TimePoint now, ResponseTime& answers) {
  if (asked_at_) {
    answers.sample(now - *asked_at_);
    asked_at_.reset();
  }
  fruitless_ = 0;
  end_first_pass();
}

void ArrivingPing::end_first_pass() {
  if (std::exchange(pass_over_, true) || !requested_) {
    return;
  }
  if (assembly_.head()) {
    ask_unasked(assembly_.line_count());
  } else if (!head_asked_) {
    ask(RetryKind::head, 1);
  }
}

/// Handles line `number` of the first pass.
void ArrivingPing::follow_first_pass(TimePoint now, int number) {
  highest_ = std::max(highest_, number);
  if (!requested_) {
    return;
  }
  if (now - marked_at_ >= reorder_patience) {
    ask_unasked(marked_);
    marked_at_ = now;
    marked_ = highest_;
  }
  const bool damaged = assembly_.lines_received() <= highest_;
  const bool ending = assembly_.head() && highest_ >= assembly_.line_count() - precaution_lines;
  if (continuous_ && damaged && ending && !std::exchange(asked_ahead_, true)) {
    ask(RetryKind::tail, copies_of_a_repeated_request);
  }
}

// ---- Requests

TimePoint ArrivingPing::due(const ResponseTime& answers) const {
  if (!requested_) {
    return last_arrival_ + unrequested_patience;
  }
  const int slower = fruitless_ - fruitless_rounds_at_full_speed;
  if (pass_over_) {
    const nanoseconds patience = answers.patience();
    return last_arrival_ + doubled(continuous_ ? std::min(patience, answer_patience_continuous) : patience,
                                   slower, patience_most);
  }
  if (assembly_.is_complete()) {
    return last_arrival_ + doubled(neighbour_patience, slower, patience_most);
  }
  const nanoseconds patience = stream_patience();
  const TimePoint quiet = last_arrival_ + doubled(patience, slower, std::max(patience, patience_most));
  const bool headless = !assembly_.head() && !head_asked_;
  return headless ? std::min(quiet, first_datagram_ + neighbour_patience) : quiet;
}

/// Longest silence within the first pass. Without a head, assumes the maximum compression of 4.
nanoseconds ArrivingPing::stream_patience() const {
  const bool before_the_end = assembly_.head() && highest_ < assembly_.line_count() - last_lines;
  const int native_lines = burst_lines << (assembly_.head() ? assembly_.head()->compression_log2() : 4);
  return (before_the_end ? patience_before_the_end : patience_at_the_end) +
         nanoseconds{static_cast<std::int64_t>(native_lines * (1e9 / line_rate_hz))};
}

bool ArrivingPing::is_over(TimePoint now) const {
  const bool only_tail_lacks = assembly_.is_complete() && fruitless_ >= rounds_for_the_tail_alone;
  return !requested_ || only_tail_lacks || now - progress_ >= give_up_after;
}

/// One round: requests everything that is missing, the head first.
void ArrivingPing::ask_again(TimePoint now) {
  if (!assembly_.head() && !head_asked_) {
    ask(RetryKind::head, 1);
    return;
  }
  ++fruitless_;
  last_arrival_ = now;
  if (!assembly_.head()) {
    ask(RetryKind::head, copies_of_a_repeated_request);
  }
  if (pass_over_) {
    asked_at_ = asked_at_.value_or(now);
    auto ranges = assembly_.missing(0, assembly_.line_count());
    ranges.resize(std::min(ranges.size(), most_ranges_a_round));
    const bool few = assembly_.line_count() - assembly_.lines_received() <= few_lines;
    for (const LineRange& range : ranges) {
      ask(RetryKind::lines, few ? copies_of_a_repeated_request : 1, range);
    }
  }
  if (!has_tail_) {
    ask(RetryKind::tail, copies_of_a_repeated_request);
  }
}

/// Requests the lines below `end` that are missing and have not been requested.
void ArrivingPing::ask_unasked(int end) {
  for (const LineRange& range : assembly_.missing(asked_to_, end)) {
    ask(RetryKind::lines, 1, range);
  }
  asked_to_ = std::max(asked_to_, end);
}

void ArrivingPing::ask(RetryKind kind, int copies, LineRange range) {
  RetryRequest request;
  request.kind = kind;
  request.first_line = static_cast<std::uint16_t>(range.first);
  request.line_count = static_cast<std::uint16_t>(range.count);
  for (int copy = 0; copy < copies; ++copy) {
    requests_.push_back(request);
    retries_.count(kind);
  }
  head_asked_ = head_asked_ || kind == RetryKind::head;
}

}  // namespace sonard::gemini
