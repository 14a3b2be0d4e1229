// SPDX-License-Identifier: Apache-2.0
// The client's side against the head itself, and against a link that loses and cuts frames (6).
#include "protocol/ping360/client.hpp"

#include "bench.hpp"

namespace sonard::ping360 {
namespace {

/// A client and a head on one line, in virtual time.
class Session {
 public:
  using Carrier = std::function<std::vector<Bytes>(const Bytes&)>;

  explicit Session(const DeviceConfig& config = {}) : head(config), client(0ns) {}

  // Set by tests: the pieces in which a frame arrives; an empty list loses the frame.
  Carrier to_head = [](const Bytes& frame) { return std::vector<Bytes>{frame}; };
  Carrier to_client = to_head;

  Bench head;
  Client client;
  std::vector<ReceivedPing> pings;

  void run_for(std::chrono::nanoseconds span) {
    const TimePoint end = head.now + span;
    exchange();
    for (;;) {
      const TimePoint own = client.next_deadline().value_or(TimePoint::max());
      const TimePoint next = std::min(head.next_event(), own);
      if (next > end) {
        break;
      }
      if (head.next_event() <= own) {
        head.run_once();
      } else {
        head.run_until(own);
      }
      exchange();
    }
    head.run_until(end);
  }
  void run_to_end(std::chrono::nanoseconds limit = 200s) {
    for (const TimePoint end = head.now + limit; !client.finished() && head.now < end;) {
      run_for(10ms);
    }
    EXPECT_TRUE(client.finished());
  }

 private:
  void exchange() {
    for (bool talks = true; talks;) {
      for (talks = false; read_ < head.heard.size(); ++read_) {
        for (const Bytes& piece : to_client(head.heard[read_].frame)) {
          client.on_bytes(head.now, piece);
        }
      }
      client.advance(head.now);
      EXPECT_TRUE(!client.next_deadline() || *client.next_deadline() > head.now);
      for (const Bytes& frame : client.take_outgoing()) {
        talks = true;
        for (const Bytes& piece : to_head(frame)) {
          head.raw(piece);
        }
      }
      for (ReceivedPing& ping : client.take_pings()) {
        pings.push_back(std::move(ping));
      }
    }
  }

  std::size_t read_ = 0;
};

TEST(Ping360Client, MeetsTheHead) {
  Session session;
  session.run_for(100ms);
  EXPECT_EQ(session.client.head().protocol, ProtocolVersion{});
  EXPECT_EQ(session.client.head().information, DeviceConfig{}.information);
  EXPECT_EQ(session.client.head().state, PingForm{});
  session.run_for(10s);
  EXPECT_EQ(session.client.statistics().frames, 3U) << "then it is quiet";
}

TEST(Ping360Client, PingsOneAfterAnother) {
  Session session;
  session.client.start(0ns, ping_at(380), 15, 5);
  session.run_to_end();
  ASSERT_EQ(session.pings.size(), 5U);
  std::vector<int> angles;
  for (const ReceivedPing& ping : session.pings) {
    angles.push_back(ping.form.settings.angle);
    EXPECT_EQ(ping.samples, test_samples(ping.number, 200));
    EXPECT_FALSE(ping.form.scan);
  }
  EXPECT_EQ(angles, (std::vector{380, 395, 10, 25, 40}));
  EXPECT_EQ(session.client.statistics().commands, 5U);
}

TEST(Ping360Client, ScansAndStopsTheScanBehindIt) {
  Session session;
  session.client.start(0ns, scan_of(390, 10, 5), 7);
  session.run_to_end();
  ASSERT_EQ(session.pings.size(), 7U);
  EXPECT_EQ(session.pings[1].form.settings.angle, 395);
  ASSERT_TRUE(session.pings[1].form.scan);
  EXPECT_EQ(session.pings[1].form.scan->num_steps, 5);
  session.run_for(1s);
  EXPECT_EQ(session.head.all<Ack>().size(), 1U);
  const std::size_t heard = session.head.heard.size();
  session.run_for(5s);
  EXPECT_EQ(session.head.heard.size(), heard);
}

TEST(Ping360Client, PingsThatComeBeforeAStopIsReadAreNotUnwanted) {
  Session session;
  int stops = 0;
  session.to_head = [&](const Bytes& frame) {
    const auto command = decode_command(frame);
    const bool stop = command && std::holds_alternative<MotorOff>(*command);
    return stop && ++stops <= 3 ? std::vector<Bytes>{} : std::vector<Bytes>{frame};
  };
  session.client.start(0ns, scan_of(390, 10, 5), 7);
  session.run_to_end();
  session.run_for(1s);
  EXPECT_GT(session.head.all<AutoDeviceData>().size(), 7U);
  EXPECT_EQ(session.pings.size(), 7U);
  EXPECT_EQ(session.client.statistics().pings_unwanted, 0U);
}

TEST(Ping360Client, GivesSignsOfLifeSoThatAScanGoesOn) {
  Session session;
  session.client.start(0ns, scan_of(0, 399, 10), 0);
  session.run_for(120s);
  const std::size_t before = session.pings.size();
  session.run_for(1s);
  EXPECT_GT(session.pings.size(), before);
  EXPECT_EQ(session.client.statistics().timeouts, 0U);
  session.client.stop(session.head.now);
  session.run_to_end(5s);
}

TEST(Ping360Client, ChangesWhatIsGoingOn) {
  Session session;
  session.client.start(0ns, scan_of(0, 399), 0);
  session.run_for(1s);
  session.client.start(session.head.now, ping_at(50), 1, 3);
  session.run_to_end();
  EXPECT_EQ(session.pings.back().form.settings.angle, 52);
  session.client.start(session.head.now, scan_of(100, 150), 2);
  session.run_to_end();
  EXPECT_EQ(session.pings.back().form.settings.angle, 101);
}

TEST(Ping360Client, ARefusalIsToldAndNotRepeated) {
  Session session;
  session.client.start(0ns, Transducer{.number_of_samples = 1250}, 1, 0);
  session.run_to_end(5s);
  ASSERT_TRUE(session.client.refusal());
  EXPECT_EQ(session.client.refusal()->text, "number_of_samples out of range");
  session.run_for(10s);
  EXPECT_EQ(session.client.statistics().commands, 1U);
}

TEST(Ping360Client, AsksAgainForWhatIsLost) {
  Session session;
  int sent = 0;
  const auto loses_every_third = [&](const Bytes& frame) {
    return ++sent % 3 == 0 ? std::vector<Bytes>{} : std::vector<Bytes>{frame};
  };
  session.to_head = loses_every_third;
  session.to_client = loses_every_third;
  session.client.start(0ns, ping_at(0), 1, 20);
  session.run_to_end(1000s);
  EXPECT_EQ(session.pings.size(), 20U);
  EXPECT_GT(session.client.statistics().timeouts, 0U);
  session.client.start(session.head.now, scan_of(0, 399), 20);
  session.run_to_end(1000s);
  EXPECT_EQ(session.pings.size(), 40U);
}

// The second copy of an answer must cause no command; otherwise two commands would stay under way for ever.
TEST(Ping360Client, ALinkThatDoublesWhatItCarriesMakesNoCommandMore) {
  Session session;
  session.to_client = [](const Bytes& frame) { return std::vector<Bytes>{frame, frame}; };
  session.client.start(0ns, ping_at(380), 15, 5);
  session.run_to_end();
  std::vector<int> angles;
  for (const ReceivedPing& ping : session.pings) {
    angles.push_back(ping.form.settings.angle);
    EXPECT_EQ(ping.samples, test_samples(ping.number, 200));
  }
  EXPECT_EQ(angles, (std::vector{380, 395, 10, 25, 40}));
  EXPECT_EQ(session.client.statistics().commands, 5U);
}

TEST(Ping360Client, ReadsAStreamCutAnywhereAmongNoise) {
  Session session;
  session.to_client = [](const Bytes& frame) {
    std::vector<Bytes> pieces{{0x00, 0xFF, 'U', 'B'}};
    for (std::size_t begin = 0; begin < frame.size(); begin += 100) {
      const auto end = std::min(begin + 100, frame.size());
      pieces.emplace_back(frame.begin() + static_cast<std::ptrdiff_t>(begin),
                          frame.begin() + static_cast<std::ptrdiff_t>(end));
    }
    return pieces;
  };
  session.client.start(0ns, ping_at(0), 1, 10);
  session.run_to_end();
  EXPECT_EQ(session.client.statistics().timeouts, 0U);
  EXPECT_GT(session.client.statistics().dropped_bytes, 0U);
}

TEST(Ping360Client, GivesUpStoppingAHeadThatDoesNotAnswer) {
  Session session;
  session.run_for(1s);
  session.to_head = [](const Bytes&) { return std::vector<Bytes>{}; };
  session.client.stop(session.head.now);
  session.run_for(2s);
  EXPECT_TRUE(session.client.finished());
  EXPECT_EQ(session.client.next_deadline(), std::nullopt);
}

}  // namespace
}  // namespace sonard::ping360
