// SPDX-License-Identifier: Apache-2.0
// No bytes from a peer make a head grow, stall or send without end. No missing peer stops it.
#include <random>

#include "tests/soak/footprint.hpp"
#include "tests/unit/protocol/contract/contract_test.hpp"

namespace sonard::contract {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Hostile = Contract;

/// Messages of clients with flipped and cut bytes. The last message is rare.
class Corrupter {
 public:
  Corrupter(std::vector<Bytes> messages, unsigned seed) : messages_(std::move(messages)), random_(seed) {}

  unsigned draw(unsigned below) { return static_cast<unsigned>(random_() % below); }
  Bytes next() {
    const auto count = static_cast<unsigned>(messages_.size());
    Bytes bytes = messages_[draw(draw(30) == 0 ? count : count - 1)];
    for (unsigned flips = draw(3) == 0 ? draw(4) : 0; flips > 0; --flips) {
      bytes[draw(static_cast<unsigned>(bytes.size()))] = static_cast<std::uint8_t>(draw(256));
    }
    if (draw(10) == 0) {
      bytes.resize(draw(static_cast<unsigned>(bytes.size() + 1)));
    }
    return bytes;
  }

 private:
  std::vector<Bytes> messages_;
  std::mt19937 random_;
};

TEST_P(Hostile, CorruptMessagesAtRandomTimesLeaveEachPingWithOneEnd) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Corrupter client(GetParam().make({})->messages(), seed);
    HeadBench bench(GetParam(), {.options = client.draw(1U << 10)});
    const std::vector<Peer> clients = bench.head->clients();
    bench.render_time = std::chrono::milliseconds(1 + client.draw(60));
    bench.lateness = [&] { return std::chrono::microseconds(client.draw(4) == 0 ? client.draw(20'000) : 0); };
    bench.connect();
    bench.request();
    for (int i = 0; i < 2000; ++i) {
      const Peer& peer = clients[client.draw(static_cast<unsigned>(clients.size()))];
      if (client.draw(100) == 0) {
        bench.leave();
        bench.step(ClientGone{peer});
        bench.connect();
      }
      bench.receive(peer, client.next());
      bench.renderer_fails = client.draw(10) == 0;
      bench.run_for(std::chrono::microseconds(client.draw(100) == 0 ? 2'000'000 : client.draw(50'000)));
    }
    EXPECT_GT(bench.counters().pings_sent, 10U);
    EXPECT_GE(bench.records.size(), bench.counters().pings_sent);
    if (!bench.head->records_broken_pings()) {
      EXPECT_EQ(bench.records.size(), bench.counters().pings_sent);
    }
    EXPECT_LE(bench.ended(), bench.counters().pings_started);
    EXPECT_GE(bench.ended() + 1, bench.counters().pings_started);
    for (const Outgoing& message : bench.sent) {
      ASSERT_TRUE(bench.head->can_read(message.bytes));
    }
  }
}

// With sanitizers the heap is not counted.
TEST_P(Hostile, AFloodTakesNoMemory) {
  const auto head = GetParam().make({});
  Corrupter client(head->messages(), 1);
  TimePoint now{};
  head->device().step(now, ClientCame{head->client()});
  const auto flood = [&] {
    for (int i = 0; i < 5000; ++i) {
      const Actions actions =
          head->device().step(now, BytesReceived{head->client(), SharedBytes(client.next())});
      EXPECT_LE(actions.send.size(), 100U);
      now += 10us;
    }
    return soak::footprint().heap_bytes;
  };
  const std::size_t before = flood();
  EXPECT_LE(flood(), before + 64 * 1024);
}

TEST_P(Hostile, AMessageCutAnywhereIsForgottenWithItsClient) {
  HeadBench bench(GetParam());
  for (const Bytes& message : bench.head->messages()) {
    for (std::size_t size = 0; size < message.size(); size += 5) {
      bench.connect();
      bench.receive(bench.head->client(),
                    {message.begin(), message.begin() + static_cast<std::ptrdiff_t>(size)});
      bench.leave();
    }
  }
  bench.connect();
  const std::size_t before = bench.records.size();
  bench.request();
  bench.run_for(1s);
  EXPECT_GT(bench.records.size(), before);
}

TEST_P(Hostile, EventsThatAreNotForThisTypeOfHeadChangeNothing) {
  HeadBench bench(GetParam());
  bench.connect();
  const Event events[] = {ClientGone{{7, {1, 2}, 3}},
                          TriggerEdge{},
                          SensorsRead{},
                          NextPingDue{},
                          PingFed{bench.head->recorded()},
                          BytesReceived{bench.head->client(), {}}};
  for (const Event& event : events) {
    bench.step(event);
    EXPECT_TRUE(bench.last.send.empty());
  }
  EXPECT_TRUE(bench.jobs.empty());
  bench.connect();
  bench.request();
  bench.run_for(300ms);
  EXPECT_GE(bench.records.size(), 1U);
}

INSTANTIATE_TEST_SUITE_P(Devices, Hostile, ::testing::ValuesIn(head_types()), name_of);

}  // namespace
}  // namespace sonard::contract
