// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/ping_transmission.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "protocol/gemini/ping_plan.hpp"

namespace sonard::gemini {

namespace {

// The receivers' timers watch the last 25 and 35 lines and run for 5 ms. One millisecond is reserved for late
// timers and the time on the wire.
constexpr int final_lines = 36;
constexpr std::chrono::nanoseconds final_window = std::chrono::milliseconds{4};

}  // namespace

PingTransmission::PingTransmission(EncodedPing ping, TimePoint transmit_time, int compression_log2)
    : ping_(std::move(ping)), transmit_time_(transmit_time), compression_log2_(compression_log2) {}

int PingTransmission::lines_sent() const {
  return std::clamp(next_ - 1, 0, ping_.line_count());
}

void PingTransmission::send(TimePoint now, Pacer& pacer, std::vector<SharedBytes>& out) {
  while (!finished() && pacer.ready(now) && now >= available_at(next_)) {
    out.push_back(ping_.datagram(next_));
    pacer.sent(now);
    ++next_;
    if (finished()) {
      tail_sent_at_ = now;
    }
  }
}

TimePoint PingTransmission::next_send(const Pacer& pacer) const {
  const int remaining = ping_.datagram_count() - next_;
  const int count =
      next_ == 0 ? 1 : std::min(pacer.wake_batch(), remaining);  // send the head at once: clients wait for it
  return std::max(pacer.earliest(count), available_at(next_ + count - 1));
}

TimePoint PingTransmission::predicted_end(const Pacer& pacer) const {
  const int tail = ping_.datagram_count() - 1;
  return std::max(pacer.earliest(tail + 1 - next_), available_at(tail));
}

TimePoint PingTransmission::available_at(int index) const {
  if (index == 0) {
    return transmit_time_;
  }
  const int lines = ping_.line_count();
  const int line = std::min(index - 1, lines - 1);  // the tail may leave with the last line
  const TimePoint line_received = transmit_time_ + acoustic_time((line + 1) << compression_log2_);
  if (line < lines - final_lines) {
    return line_received;
  }
  const TimePoint all_received = transmit_time_ + acoustic_time(lines << compression_log2_);
  return std::max(line_received, all_received - final_window);
}

}  // namespace sonard::gemini
