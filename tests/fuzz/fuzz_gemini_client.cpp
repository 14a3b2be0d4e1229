// SPDX-License-Identifier: Apache-2.0
// Any sequence of datagrams and pauses against the client's side of the protocol.
// Promises: every datagram sent is a command; a delivered image has the size that its head announced; time
// goes on with any input.
#include "protocol/common/ping_job.hpp"
#include "protocol/gemini/client.hpp"
#include "protocol/gemini/codec.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/fuzz/script.hpp"

namespace {

using namespace sonard::gemini;
using sonard::TimePoint;
using sonard::fuzz::Event;
using sonard::fuzz::require;
using sonard::fuzz::Script;

constexpr std::uint16_t sonar_id = 601;

/// Kinds of events. Those below start_single carry a datagram from the head.
enum Kind { start_single = 4, start_continuous = 5, stop = 6 };

class Bench {
 public:
  void play(const Event& event) {
    run_until(now_ + event.delay);
    PingConfig config;
    switch (event.kind) {
      case start_single:
        client_.start(now_, config, 0);
        break;
      case start_continuous:
        config.run_mode = 1;
        client_.start(now_, config, 3);
        break;
      case stop:
        client_.stop();
        break;
      default:
        if (event.kind < start_single) {
          client_.on_datagram(now_, event.datagram);
        }
    }
    advance();
  }

 private:
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
    for (const ClientDatagram& datagram : client_.take_outgoing()) {
      const auto command = decode_command(datagram.bytes);
      require(command.has_value() && !std::holds_alternative<Unknown>(*command),
              "a client speaks its protocol");
      require(datagram.bytes.size() <= max_datagram_size, "no datagram fragments");
    }
    for (const ReceivedPing& ping : client_.take_pings()) {
      const auto lines = static_cast<std::size_t>(ping.head.line_count());
      require(ping.samples.u8.size() + ping.samples.u16.size() == lines * ping.head.beams,
              "an image has the size that its head announced");
      require(ping.samples.u8.empty() || ping.samples.u16.empty(), "an image has one kind of samples");
    }
  }

  TimePoint now_{};
  Client client_{ClientConfig{}};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bench bench;
  for (Script script{{data, size}, start_single}; !script.done();) {
    Event event = script.next();
    sonard::fuzz::address_to_gemini(event, sonar_id);
    bench.play(event);
  }
  return 0;
}
