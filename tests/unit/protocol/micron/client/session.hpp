// SPDX-License-Identifier: Apache-2.0
// A client and a head on one line, in virtual time.
#pragma once

#include "protocol/micron/client.hpp"
#include "protocol/micron/units.hpp"
#include "tests/unit/protocol/micron/device/bench.hpp"

namespace sonard::micron {

class Session {
 public:
  using Carrier = std::function<std::vector<Bytes>(const Bytes&)>;

  explicit Session(const DeviceConfig& head_config = {}, const ClientConfig& client_config = {})
      : head(head_config), client(client_config, 0ns) {}

  // Set by tests: the pieces in which a frame arrives; an empty list loses the frame.
  Carrier to_head = [](const Bytes& frame) { return std::vector<Bytes>{frame}; };
  Carrier to_client = to_head;
  std::chrono::nanoseconds byte_time{0};  ///< on the way to the client

  // Read by tests.
  Bench head;
  Client client;
  std::vector<Bytes> said;  ///< frames sent by the client
  std::vector<ReceivedLine> lines;

  TimePoint now() const { return head.now; }

  void run_for(std::chrono::nanoseconds span) {
    const TimePoint end = head.now + span;
    exchange();
    while (std::min(head.next_event(), client_event()) <= end) {
      if (head.next_event() <= client_event()) {
        head.run_once();
      } else {
        head.run_until(client_event());
      }
      exchange();
    }
    head.run_until(end);
  }
  /// Runs until the client has finished, and fails the test if that takes longer than `limit`.
  void run_to_end(std::chrono::nanoseconds limit = 200s) {
    for (const TimePoint end = head.now + limit; !client.finished() && head.now < end;) {
      run_for(10ms);
    }
    EXPECT_TRUE(client.finished());
  }

 private:
  TimePoint client_event() const {
    return std::max(head.now, std::min(arrival(), client.next_deadline().value_or(TimePoint::max())));
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
        for (const Bytes& piece : to_client(head.sent[read_].bytes)) {
          client.on_bytes(head.now, piece);
        }
      }
      client.advance(head.now);
      EXPECT_TRUE(!client.next_deadline() || *client.next_deadline() > head.now)
          << "the client would keep its caller spinning";
      for (const Bytes& frame : client.take_outgoing()) {
        talks = true;
        said.push_back(frame);
        for (const Bytes& piece : to_head(frame)) {
          head.raw(piece);
        }
      }
      for (ReceivedLine& line : client.take_lines()) {
        lines.push_back(std::move(line));
      }
    }
  }

  std::size_t read_ = 0;
  TimePoint last_arrival_{};
};

}  // namespace sonard::micron
