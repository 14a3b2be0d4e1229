// SPDX-License-Identifier: Apache-2.0
// Any sequence of bytes and pauses against the client's side of a Micron.
// Promises: every frame sent is a command; a delivered line has the requested bins; the next deadline lies in
// the future.
#include "protocol/micron/client.hpp"
#include "protocol/micron/codec.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/fuzz/script.hpp"

namespace {

using namespace sonard::micron;
using sonard::TimePoint;
using sonard::fuzz::Event;
using sonard::fuzz::require;
using sonard::fuzz::Script;

/// Kinds of events. The first carries bytes: type and data of a frame, or a raw piece of stream.
enum Kind { byte_kinds = 1, start_8_bit = 1, start_4_bit = 2, stop = 3, gain = 4, reverse = 5 };

constexpr int bins = 8;

class Bench {
 public:
  void play(const Event& event) {
    run_until(now_ + event.delay);
    HeadCommand command;
    command.bins = bins;
    switch (event.kind) {
      case start_8_bit:
        client_.start(now_, command, 0);
        break;
      case start_4_bit:
        command.control &= static_cast<std::uint16_t>(~control_bits::eight_bit);
        client_.start(now_, command, 3);
        break;
      case stop:
        client_.stop();
        break;
      case gain:
        client_.set_gain({});
        break;
      case reverse:
        client_.reverse();
        break;
      default:
        if (event.kind < byte_kinds) {
          hear(event);
        }
    }
    advance();
  }

 private:
  void hear(const Event& event) {
    if (event.as_is || event.datagram.empty()) {
      client_.on_bytes(now_, event.datagram);
    } else {
      client_.on_bytes(
          now_, frame_from_head(default_head_node, event.datagram[0], std::span{event.datagram}.subspan(1)));
    }
  }

  void run_until(TimePoint target) {
    constexpr int most_wake_ups = 1000;
    for (int i = 0; i < most_wake_ups; ++i) {
      const auto deadline = client_.next_deadline();
      if (!deadline || *deadline > target) {
        break;
      }
      now_ = std::max(now_, *deadline);
      advance();
    }
    now_ = target;
    advance();
  }

  void advance() {
    client_.advance(now_);
    for (const auto& frame : client_.take_outgoing()) {
      const auto command = decode_command(frame);
      require(command.has_value() && !std::holds_alternative<Unknown>(*command),
              "a client speaks its protocol");
    }
    for (const ReceivedLine& line : client_.take_lines()) {
      require(line.bins.size() == bins, "a line has the bins that were asked for");
    }
    const auto deadline = client_.next_deadline();
    require(!deadline || *deadline > now_, "the next deadline is later than now");
  }

  TimePoint now_{};
  Client client_{ClientConfig{}, now_};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bench bench;
  for (Script script{{data, size}, byte_kinds}; !script.done();) {
    bench.play(script.next());
  }
  return 0;
}
