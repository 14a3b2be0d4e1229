// SPDX-License-Identifier: Apache-2.0
// A host and a head on one line, in virtual time.
#pragma once

#include "protocol/micron/host.hpp"
#include "protocol/micron/units.hpp"
#include "tests/unit/protocol/micron/device/bench.hpp"

namespace sonard::micron {

class Session {
 public:
  using Carrier = std::function<std::vector<Bytes>(const Bytes&)>;

  explicit Session(const DeviceConfig& head_config = {}, const HostConfig& host_config = {})
      : head(head_config), host(host_config, 0ns) {}

  // Set by tests: the pieces in which a frame arrives; an empty list loses the frame.
  Carrier to_head = [](const Bytes& frame) { return std::vector<Bytes>{frame}; };
  Carrier to_host = to_head;
  std::chrono::nanoseconds byte_time{0};  ///< on the way to the host

  // Read by tests.
  Bench head;
  Host host;
  std::vector<Bytes> said;  ///< frames sent by the host
  std::vector<ReceivedLine> lines;

  TimePoint now() const { return head.now; }

  void run_for(std::chrono::nanoseconds span) {
    const TimePoint end = head.now + span;
    exchange();
    while (std::min(head.next_event(), host_event()) <= end) {
      if (head.next_event() <= host_event()) {
        head.run_once();
      } else {
        head.run_until(host_event());
      }
      exchange();
    }
    head.run_until(end);
  }
  /// Runs until the host has finished, and fails the test if that takes longer than `limit`.
  void run_to_end(std::chrono::nanoseconds limit = 200s) {
    for (const TimePoint end = head.now + limit; !host.finished() && head.now < end;) {
      run_for(10ms);
    }
    EXPECT_TRUE(host.finished());
  }

 private:
  TimePoint host_event() const {
    return std::max(head.now, std::min(arrival(), host.next_deadline().value_or(TimePoint::max())));
  }
  /// Arrival time of the last byte of the next frame from the head.
  TimePoint arrival() const {
    if (read_ == head.sent.size()) {
      return TimePoint::max();
    }
    const Bench::Sent& frame = head.sent[read_];
    return std::max(frame.at, last_arrival_) + static_cast<int>(frame.bytes.size()) * byte_time;
  }
  void exchange() {
    for (bool talks = true; talks;) {
      talks = false;
      for (; arrival() <= head.now; ++read_) {
        last_arrival_ = arrival();
        for (const Bytes& piece : to_host(head.sent[read_].bytes)) {
          host.on_bytes(head.now, piece);
        }
      }
      host.advance(head.now);
      EXPECT_TRUE(!host.next_deadline() || *host.next_deadline() > head.now)
          << "the host would keep its caller spinning";
      for (const Bytes& frame : host.take_outgoing()) {
        talks = true;
        said.push_back(frame);
        for (const Bytes& piece : to_head(frame)) {
          head.raw(piece);
        }
      }
      for (ReceivedLine& line : host.take_lines()) {
        lines.push_back(std::move(line));
      }
    }
  }

  std::size_t read_ = 0;
  TimePoint last_arrival_{};
};

}  // namespace sonard::micron
