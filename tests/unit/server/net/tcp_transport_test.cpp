// SPDX-License-Identifier: Apache-2.0
// Clients of a head that is a TCP server: they connect, send, stall, are disconnected, and leave.
#include "server/net/tcp_transport.hpp"

#include <chrono>
#include <functional>
#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <boost/asio/io_context.hpp>

#include "server/net/udp_endpoint.hpp"
#include "tests/support/serial_client.hpp"
#include "tests/unit/server/net/link_fixture.hpp"

namespace sonard::server {
namespace {

using test::Bytes;
using test::Client;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr Ipv4 localhost = 0x7F000001;

/// `size` bytes: the message's number, its size in four bytes, then its number repeated.
Bytes numbered(std::uint8_t number, std::size_t size) {
  Bytes message(size, number);
  for (std::size_t i = 0; i < 4; ++i) {
    message[1 + i] = static_cast<std::uint8_t>(size >> (8 * i));
  }
  return message;
}

/// The numbers of the messages in a stream. A partial message fails the test.
std::vector<int> numbers_in(const Bytes& stream) {
  std::vector<int> numbers;
  for (std::size_t at = 0; at + 5 <= stream.size();) {
    std::size_t size = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      size |= std::size_t{stream[at + 1 + i]} << (8 * i);
    }
    numbers.push_back(stream[at]);
    if (size < 5 || at + size > stream.size()) {
      ADD_FAILURE() << "half a message at byte " << at;
      break;
    }
    const Bytes message(stream.begin() + static_cast<std::ptrdiff_t>(at),
                        stream.begin() + static_cast<std::ptrdiff_t>(at + size));
    EXPECT_EQ(message, numbered(stream[at], size)) << "at byte " << at;
    at += size;
  }
  return numbers;
}

class TcpTransportTest : public testing::Test {
 protected:
  TcpTransportTest() : transport_(io_, {{localhost, 0}, {{0x7F000000, 8}}}, clock_) {
    TransportEvents events;
    events.received = [this](const BytesReceived& received) {
      heard_.insert(heard_.end(), received.bytes.begin(), received.bytes.end());
      from_ = received.from;
      if (on_received_) {
        on_received_(received.from);
      }
    };
    events.came = [this](const ClientCame& client) { came_.push_back(client.who); };
    events.gone = [this](const ClientGone& client) { gone_.push_back(client.who); };
    events.passed = [this](const WirePassed& passed) {
      for (const WirePiece& piece : passed.pieces) {
        (passed.to_client ? passed_out_ : passed_in_) += piece.bytes.size();
      }
    };
    events.ended = [this](const WireEnds& ends) { ended_.push_back(ends.client); };
    transport_.start(std::move(events));
  }
  ~TcpTransportTest() override { transport_.stop(); }

  bool run_until(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{30};
    while (!condition() && std::chrono::steady_clock::now() < deadline) {
      io_.run_one_for(std::chrono::milliseconds{1});
      io_.restart();
    }
    return condition();
  }
  Client client(int receive_buffer_bytes = 0) {
    const std::size_t before = came_.size();
    Client client = Client::tcp(transport_.local_endpoint(), localhost, receive_buffer_bytes);
    EXPECT_TRUE(run_until([&] { return came_.size() > before; }));
    return client;
  }
  void send(const Peer& to, const Bytes& bytes) {
    transport_.send({{Outgoing::To::peer, to, SharedBytes(bytes)}});
  }
  std::uint64_t count(const std::string& name) const {
    for (const Counter& counter : transport_.counts()) {
      if (counter.name == name) {
        return counter.value;
      }
    }
    ADD_FAILURE() << "no counter " << name;
    return 0;
  }

  boost::asio::io_context io_;
  SteppedClock clock_;
  TcpTransport transport_;
  Bytes heard_;
  Peer from_;
  std::function<void(const Peer&)> on_received_;
  std::vector<Peer> came_, gone_;
  std::vector<Endpoint> ended_;
  std::size_t passed_in_ = 0, passed_out_ = 0;
};

TEST_F(TcpTransportTest, TellsWhoComesSendsAndGoes) {
  Client one = client();
  EXPECT_THAT(came_, ElementsAre(Peer{0, one.endpoint(), localhost}));
  one.write(Bytes{1, 2, 3});
  ASSERT_TRUE(run_until([&] { return heard_.size() == 3; }));
  EXPECT_EQ(from_, came_[0]);
  EXPECT_EQ(passed_in_, 3U);
  one.close();
  ASSERT_TRUE(run_until([&] { return !gone_.empty(); }));
  EXPECT_EQ(gone_, came_);
  EXPECT_THAT(ended_, ElementsAre(came_[0].remote));
}

TEST_F(TcpTransportTest, SendsToTheClientThatIsNamedAndBroadcastsToNone) {
  Client one = client();
  Client two = client();
  send(came_[1], numbered(1, 100));
  transport_.send({{Outgoing::To::everybody, {}, SharedBytes(numbered(2, 100))}});
  ASSERT_TRUE(run_until([&] { return two.heard().size() == 100; }));
  EXPECT_THAT(one.heard(), IsEmpty());
  EXPECT_EQ(numbers_in(two.heard()), std::vector<int>{1});
  EXPECT_EQ(passed_out_, 100U);
}

TEST_F(TcpTransportTest, AMessageOfMegabytesArrivesWhole) {
  Client one = client();
  const Bytes message = numbered(7, 3'000'000);
  send(came_[0], message);
  ASSERT_TRUE(run_until([&] { return one.heard().size() == message.size(); }));
  EXPECT_EQ(one.heard(), message);
  EXPECT_EQ(count("messages_dropped"), 0U);
}

TEST_F(TcpTransportTest, ASlowReaderMissesWholeLongMessagesAndNoShortOnes) {
  Client slow = client(4096);
  std::vector<int> short_ones;
  for (int i = 0; i < 100; ++i) {
    const bool is_short = i % 2 == 1;
    send(came_[0], numbered(static_cast<std::uint8_t>(i), is_short ? 16 : 300'000));
    if (is_short) {
      short_ones.push_back(i);
    }
    io_.poll();
    io_.restart();
  }
  EXPECT_GT(count("messages_dropped"), 40U);
  const auto all_read = [&] {
    return slow.heard().size() == passed_out_ && count("bytes_out") == passed_out_;
  };
  ASSERT_TRUE(run_until(all_read));
  const std::vector<int> numbers = numbers_in(slow.heard());
  std::vector<int> arrived_short;
  for (const int number : numbers) {
    if (number % 2 == 1) {
      arrived_short.push_back(number);
    }
  }
  EXPECT_EQ(arrived_short, short_ones);
  EXPECT_EQ(numbers.size() + count("messages_dropped"), 100U);
  send(came_[0], numbered(101, 300'000));  // after that it continues
  ASSERT_TRUE(run_until(all_read));
  EXPECT_EQ(numbers_in(slow.heard()).back(), 101);
}

TEST_F(TcpTransportTest, ShortMessagesWaitUpToABound) {
  Client deaf = client(4096);
  send(came_[0], numbered(1, 3'000'000));
  constexpr std::size_t size = 4096;
  const std::size_t fit = TcpTransport::most_waiting_bytes / size;
  for (std::size_t i = 0; i < 3 * fit; ++i) {
    send(came_[0], numbered(2, size));
  }
  EXPECT_EQ(count("messages_dropped"), 2 * fit);
}

TEST_F(TcpTransportTest, WhoTakesNoMessageForHalfAMinuteIsClosedWhenAnotherComes) {
  Client deaf = client(4096);
  Client idle = client();
  send(came_[0], numbered(1, 3'000'000));
  io_.poll();
  io_.restart();
  clock_.time += TcpTransport::most_stall - TimePoint{1};
  const Client early = client();
  EXPECT_THAT(gone_, IsEmpty());
  clock_.time += TimePoint{1};
  const Client next = client();
  EXPECT_EQ(gone_, std::vector<Peer>{came_[0]}) << "nothing was sent to the others";
}

TEST_F(TcpTransportTest, WithAStallLimitWhoTakesNoMessageIsClosedAtTheNextOne) {
  TcpTransport strict(io_, {{localhost, 0}, {{0x7F000000, 8}}, std::chrono::seconds{10}}, clock_);
  std::vector<Peer> came, gone;
  TransportEvents events;
  events.received = [](const BytesReceived&) {};
  events.came = [&](const ClientCame& who) { came.push_back(who.who); };
  events.gone = [&](const ClientGone& who) { gone.push_back(who.who); };
  strict.start(events);
  Client deaf = Client::tcp(strict.local_endpoint(), localhost, 4096);
  Client idle = Client::tcp(strict.local_endpoint());
  ASSERT_TRUE(run_until([&] { return came.size() == 2; }));
  const auto say = [&](const Peer& to, std::size_t size) {
    strict.send({{Outgoing::To::peer, to, SharedBytes(numbered(1, size))}});
    io_.poll();
    io_.restart();
  };
  say(came[0], 3'000'000);
  clock_.time += std::chrono::seconds{10} - TimePoint{1};
  say(came[0], 100);
  EXPECT_THAT(gone, IsEmpty());
  clock_.time += TimePoint{1};
  say(came[1], 100);
  EXPECT_THAT(gone, IsEmpty()) << "only a message to it closes it";
  say(came[0], 100);
  EXPECT_EQ(gone, std::vector<Peer>{came[0]});
  EXPECT_TRUE(run_until([&] { return idle.heard().size() == 100; }));
}

TEST_F(TcpTransportTest, DisconnectsAClientAndTellsSoAfterwards) {
  Client one = client();
  Client two = client();
  transport_.disconnect(came_[1]);
  EXPECT_THAT(gone_, IsEmpty());
  ASSERT_TRUE(run_until([&] { return !gone_.empty(); }));
  EXPECT_EQ(gone_[0], came_[1]);
  EXPECT_TRUE(run_until([&] { return two.closed_by_peer(); }));
  send(came_[1], numbered(1, 10));
  EXPECT_EQ(count("messages_lost"), 1U);
  send(came_[0], numbered(1, 10));
  EXPECT_TRUE(run_until([&] { return one.heard().size() == 10; }));
}

TEST_F(TcpTransportTest, MayBeToldToDisconnectWhoIsBeingHeard) {
  Client one = client();
  on_received_ = [this](const Peer& from) { transport_.disconnect(from); };
  one.write(Bytes{1});
  ASSERT_TRUE(run_until([&] { return !gone_.empty(); }));
  EXPECT_EQ(gone_.size(), 1U);
}

TEST_F(TcpTransportTest, WhoHasLeftBeforeAnotherCameIsToldFirst) {
  for (int i = 0; i < 20; ++i) {
    const std::size_t before = came_.size();
    Client one = client();
    one.close();
    Client two = Client::tcp(transport_.local_endpoint());
    std::size_t gone_when_it_came = 0;
    ASSERT_TRUE(run_until([&] {
      gone_when_it_came = came_.size() < before + 2 ? gone_.size() : gone_when_it_came;
      return came_.size() == before + 2 && gone_.size() == before + 1;
    }));
    two.close();
    ASSERT_TRUE(run_until([&] { return gone_.size() == before + 2; }));
    EXPECT_EQ(gone_when_it_came, before + 1);
  }
}

TEST_F(TcpTransportTest, MovesToAnotherAddressAndDisconnectsWhoWasAtTheOldOne) {
  Client one = client();
  const Endpoint before = transport_.local_endpoint();
  transport_.rebind({0x7F000002, before.port});
  EXPECT_EQ(transport_.local_endpoint(), (Endpoint{0x7F000002, before.port}));
  EXPECT_EQ(gone_, came_);
  ASSERT_TRUE(run_until([&] { return one.closed_by_peer(); }));
  Client two = client();
  two.write(Bytes{1, 2, 3});
  ASSERT_TRUE(run_until([&] { return heard_.size() == 3; }));
  EXPECT_EQ(from_.local, 0x7F000002U);
}

TEST_F(TcpTransportTest, StaysWhereItIsWhenItCannotMove) {
  Client one = client();
  const Endpoint before = transport_.local_endpoint();
  TcpTransport other(io_, {{0x7F000002, 0}, {{0x7F000000, 8}}}, clock_);
  EXPECT_THROW(transport_.rebind(other.local_endpoint()), SocketError);
  EXPECT_EQ(transport_.local_endpoint(), before);
  one.write(Bytes{1, 2, 3});
  ASSERT_TRUE(run_until([&] { return heard_.size() == 3; }));
}

TEST_F(TcpTransportTest, AnotherAddressThanThoseAllowedIsRefused) {
  TcpTransport closed(io_, {{localhost, 0}, {{0x0A000000, 8}}}, clock_);
  TransportEvents events;
  events.came = [](const ClientCame&) { ADD_FAILURE() << "came in"; };
  closed.start(std::move(events));
  Client one = Client::tcp(closed.local_endpoint());
  EXPECT_TRUE(run_until([&] { return one.closed_by_peer(); }));
  EXPECT_THROW(TcpTransport(io_, {closed.local_endpoint(), {}}, clock_), SocketError);
}

}  // namespace
}  // namespace sonard::server
