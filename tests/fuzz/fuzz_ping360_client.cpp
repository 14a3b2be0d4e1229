// SPDX-License-Identifier: Apache-2.0
// Any sequence of bytes and pauses against the client's side of a Ping360.
// Promises: every frame sent is a command, or empty; a delivered ping views no buffer that is gone; the next
// deadline lies in the future.
#include "protocol/ping360/client.hpp"
#include "protocol/ping360/codec.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/fuzz/script.hpp"

namespace {

using namespace sonard::ping360;
using sonard::TimePoint;
using sonard::fuzz::Event;
using sonard::fuzz::require;
using sonard::fuzz::Script;

/// Kinds of events. The first carries bytes: number and payload of a message, or a raw piece of stream.
enum Kind { byte_kinds = 1, start_turning = 1, start_scan = 2, stop = 3 };

class Bench {
 public:
  void play(const Event& event) {
    run_until(now_ + event.delay);
    switch (event.kind) {
      case start_turning:
        client_.start(now_, Transducer{}, 7, 3);
        break;
      case start_scan:
        client_.start(now_, AutoTransmit{}, 0);
        break;
      case stop:
        client_.stop(now_);
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
    const std::span<const std::uint8_t> bytes = event.datagram;
    if (event.as_is || bytes.size() < 2) {
      client_.on_bytes(now_, bytes);
    } else {
      client_.on_bytes(now_, make_frame(static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8),
                                        default_device_id, client_id, bytes.subspan(2)));
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
      require(frame.empty() || (command.has_value() && !std::holds_alternative<Unknown>(*command)),
              "a client speaks its protocol");
    }
    for (const ReceivedPing& ping : client_.take_pings()) {
      require(ping.form.settings.data.empty(), "a ping views no buffer that is gone");
    }
    const auto deadline = client_.next_deadline();
    require(!deadline || *deadline > now_, "the next deadline is later than now");
  }

  TimePoint now_{};
  Client client_{now_};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bench bench;
  for (Script script{{data, size}, byte_kinds}; !script.done();) {
    bench.play(script.next());
  }
  return 0;
}
