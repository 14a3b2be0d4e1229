// SPDX-License-Identifier: Apache-2.0
#include "server/net/several_transports.hpp"

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

/// Records its calls, and reports events when a test requests it.
class ScriptedTransport final : public Transport {
 public:
  void start(TransportEvents given) override { events = std::move(given); }
  void stop() override { stopped = true; }
  void send(std::vector<Outgoing> messages) override {
    for (Outgoing& message : messages) {
      sent.push_back(std::move(message));
    }
  }
  void disconnect(const Peer& client) override { disconnected.push_back(client); }
  bool blocked() const override { return full; }
  std::vector<std::string> descriptions() const override { return {"a way"}; }
  std::vector<Counter> counts() const override {
    return {{"sent", sent.size()}, {"", 1, "", Counter::Fault::none, Counter::Shown::warns, "{} of this"}};
  }

  TransportEvents events;
  std::vector<Outgoing> sent;
  std::vector<Peer> disconnected;
  bool full = false, stopped = false;
};

struct SeveralTransportsTest : testing::Test {
  ScriptedTransport *first, *second;
  std::unique_ptr<SeveralTransports> both;
  std::vector<BytesReceived> received;
  std::vector<ClientCame> came;
  std::vector<ClientGone> gone;

  SeveralTransportsTest() {
    std::vector<std::unique_ptr<Transport>> transports;
    for (ScriptedTransport** transport : {&first, &second}) {
      auto made = std::make_unique<ScriptedTransport>();
      *transport = made.get();
      transports.push_back(std::move(made));
    }
    both = std::make_unique<SeveralTransports>(std::move(transports));
    TransportEvents events;
    events.received = [this](BytesReceived bytes) { received.push_back(std::move(bytes)); };
    events.came = [this](const ClientCame& client) { came.push_back(client); };
    events.gone = [this](const ClientGone& client) { gone.push_back(client); };
    both->start(std::move(events));
  }
};

TEST_F(SeveralTransportsTest, TellWhichWayAMessageCame) {
  second->events.received({{0, {1, 2}, 3}, SharedBytes({4})});
  first->events.received({{0, {5, 6}, 0}, SharedBytes({7})});
  second->events.gone({});
  ASSERT_EQ(received.size(), 2U);
  EXPECT_EQ(received[0].from, (Peer{1, {1, 2}, 3}));
  EXPECT_EQ(received[1].from, (Peer{0, {5, 6}, 0}));
  ASSERT_EQ(gone.size(), 1U);
  EXPECT_EQ(gone[0].who.channel, 1);
}

TEST_F(SeveralTransportsTest, TellWhichWayAClientCameAndDisconnectItThere) {
  second->events.came({{0, {1, 2}, 3}});
  ASSERT_EQ(came.size(), 1U);
  EXPECT_EQ(came[0].who, (Peer{1, {1, 2}, 3}));
  both->disconnect(came[0].who);
  EXPECT_EQ(second->disconnected.size(), 1U);
  EXPECT_TRUE(first->disconnected.empty());
}

TEST_F(SeveralTransportsTest, SendTheWayThatIsNamedAndToEverybodyAllWays) {
  both->send({{Outgoing::To::peer, {1, {1, 2}, 0}, SharedBytes({1})},
              {Outgoing::To::everybody, {}, SharedBytes({2})},
              {Outgoing::To::peer, {0, {1, 2}, 0}, SharedBytes({3})},
              {Outgoing::To::peer, {9, {}, 0}, SharedBytes({4})}});
  ASSERT_EQ(first->sent.size(), 2U);
  EXPECT_EQ(first->sent[0].bytes[0], 2);
  EXPECT_EQ(first->sent[1].bytes[0], 3);
  ASSERT_EQ(second->sent.size(), 2U);
  EXPECT_EQ(second->sent[0].bytes[0], 1);
  EXPECT_EQ(second->sent[1].bytes[0], 2);
}

TEST_F(SeveralTransportsTest, AreBlockedWhereOneIsAndCountTogether) {
  EXPECT_FALSE(both->blocked());
  second->full = true;
  EXPECT_TRUE(both->blocked());
  first->sent.resize(2);
  second->sent.resize(3);
  const std::vector<Counter> counts = both->counts();
  ASSERT_EQ(counts.size(), 2U);
  EXPECT_EQ(counts[0].name, "sent");
  EXPECT_EQ(counts[0].value, 5U);
  EXPECT_EQ(counts[1].value, 2U);
  EXPECT_EQ(both->descriptions().size(), 2U);
  both->stop();
  EXPECT_TRUE(first->stopped && second->stopped);
}

}  // namespace
}  // namespace sonard::server
