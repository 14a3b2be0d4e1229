// SPDX-License-Identifier: Apache-2.0
// A serial line over TCP, with clients that connect, disconnect and stall at any byte.
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <memory>

#include "tests/unit/server/net/link_fixture.hpp"

namespace sonard::server {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class TcpLink : public LinkTest {
 protected:
  TcpLink() { open({{any_tcp}, {}, {}, 0}); }
};

TEST_F(TcpLink, PassesEveryByteBothWaysUnchanged) {
  Client client = tcp_client();
  ASSERT_TRUE(run_until_connections(1));
  Bytes all(256);
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i] = static_cast<std::uint8_t>(i);
  }
  client.write(all);
  EXPECT_TRUE(run_until_heard(all));
  link_->send(all);
  EXPECT_TRUE(run_until_hears(client, all));
  EXPECT_EQ(link_->counters().ports.bytes_in, 256U);
  EXPECT_EQ(link_->counters().ports.bytes_out, 256U);
}

TEST_F(TcpLink, TakesCommandsInAnyPieces) {
  Client client = tcp_client();
  Bytes three;
  for (int i = 0; i < 3; ++i) {
    three.insert(three.end(), send_version.begin(), send_version.end());
  }
  for (std::size_t piece = 1; piece <= three.size(); ++piece) {
    heard_.clear();
    for (std::size_t at = 0; at < three.size(); at += piece) {
      client.write(std::span(three).subspan(at, std::min(piece, three.size() - at)));
    }
    ASSERT_TRUE(run_until_heard(three)) << "pieces of " << piece;
  }
}

TEST_F(TcpLink, EachFrameArrivesInOnePiece) {
  Client client = tcp_client();
  ASSERT_TRUE(run_until_connections(1));
  for (const std::size_t size : {22U, 264U, 445U, 1545U}) {
    const Bytes frame = numbered_frame(1, size);
    link_->send(frame);
    ASSERT_TRUE(run_until([&] { return client.readable() > 0; }));
    EXPECT_EQ(client.read_once(), frame);
  }
}

/// The link's socket of a client's connection, which is in this process too; -1 if there is none.
int other_end(const Client& client) {
  for (int fd = 0; fd < 1024; ++fd) {
    sockaddr_in peer{};
    socklen_t length = sizeof peer;
    if (getpeername(fd, reinterpret_cast<sockaddr*>(&peer), &length) == 0 && peer.sin_family == AF_INET &&
        ntohs(peer.sin_port) == client.endpoint().port) {
      return fd;
    }
  }
  return -1;
}

int option(int fd, int level, int name) {
  int value = -1;
  socklen_t length = sizeof value;
  EXPECT_EQ(getsockopt(fd, level, name, &value, &length), 0);
  return value;
}

TEST_F(TcpLink, SmallFramesDoNotWaitAndVanishedClientsAreNoticed) {
  Client client = tcp_client();
  ASSERT_TRUE(run_until_connections(1));
  const int fd = other_end(client);
  EXPECT_NE(option(fd, IPPROTO_TCP, TCP_NODELAY), 0);
  EXPECT_NE(option(fd, SOL_SOCKET, SO_KEEPALIVE), 0);
  const int gives_up_after_s = option(fd, IPPROTO_TCP, TCP_KEEPIDLE) +
                               option(fd, IPPROTO_TCP, TCP_KEEPINTVL) * option(fd, IPPROTO_TCP, TCP_KEEPCNT);
  EXPECT_LE(gives_up_after_s, 60);
  // If frames are under way to the client, the kernel would otherwise try for a quarter of an hour.
  EXPECT_EQ(option(fd, IPPROTO_TCP, TCP_USER_TIMEOUT), 30'000);
}

TEST_F(TcpLink, ClientsMayDropAtAnyByte) {
  for (std::size_t cut = 0; cut <= send_version.size(); ++cut) {
    for (const bool with_reset : {false, true}) {
      heard_.clear();
      left_.clear();
      peers_.clear();
      Client client = tcp_client();
      const std::string name = "tcp " + endpoint_text(client.endpoint());
      const Bytes part(send_version.begin(), send_version.begin() + static_cast<std::ptrdiff_t>(cut));
      client.write(part);
      ASSERT_TRUE(run_until_heard(part));
      ASSERT_TRUE(run_until([&] { return link_->connected(); }));
      with_reset ? client.reset() : client.close();
      ASSERT_TRUE(run_until_left(1)) << cut;
      EXPECT_THAT(left_, ElementsAre(name));
      EXPECT_THAT(peers_, testing::Each(name));
      EXPECT_FALSE(link_->connected());
    }
  }
  Client next = tcp_client();
  heard_.clear();
  next.write(send_version);
  EXPECT_TRUE(run_until_heard(send_version));
  link_->send(alive);
  EXPECT_TRUE(run_until_hears(next, alive));
}

TEST_F(TcpLink, HearsWhatWasSentJustBeforeLeaving) {
  Client client = tcp_client();
  client.write(send_version);
  client.close();
  ASSERT_TRUE(run_until_left(1));
  EXPECT_EQ(heard_, send_version);
}

TEST_F(TcpLink, WhatNobodyHearsIsNeverSentLater) {
  for (int i = 0; i < 10; ++i) {
    link_->send(numbered_frame(i, 50));
  }
  EXPECT_EQ(link_->counters().frames_unheard, 10U);
  Client client = tcp_client();
  ASSERT_TRUE(run_until_connections(1));
  link_->send(alive);
  EXPECT_TRUE(run_until_hears(client, alive));
  EXPECT_EQ(link_->counters().ports.bytes_out, alive.size());
}

TEST_F(TcpLink, AllClientsHearAll) {
  Client one = tcp_client();
  Client two = tcp_client();
  ASSERT_TRUE(run_until_connections(2));
  one.write(Bytes{1});
  ASSERT_TRUE(run_until_heard({1}));
  two.write(Bytes{2});
  ASSERT_TRUE(run_until_heard({1, 2}));
  EXPECT_THAT(peers_,
              ElementsAre("tcp " + endpoint_text(one.endpoint()), "tcp " + endpoint_text(two.endpoint())));
  link_->send(alive);
  EXPECT_TRUE(run_until_hears(one, alive));
  EXPECT_TRUE(run_until_hears(two, alive));
  EXPECT_EQ(link_->counters().ports.bytes_out, 2 * alive.size());
  one.close();
  ASSERT_TRUE(run_until_left(1));
  EXPECT_TRUE(link_->connected());
}

TEST_F(TcpLink, WhoDoesNotReadLosesWholeFramesAndNobodyElseDoes) {
  constexpr std::size_t size = 1545;
  constexpr int frames = 150;
  Client slow = tcp_client(localhost, /*receive_buffer_bytes=*/4096);
  Client good = tcp_client();
  ASSERT_TRUE(run_until_connections(2));
  for (int i = 0; i < frames; ++i) {
    link_->send(numbered_frame(i, size));
    ASSERT_TRUE(run_until([&] { return good.heard().size() == (static_cast<std::size_t>(i) + 1) * size; }))
        << i;
  }
  EXPECT_EQ(frame_numbers(good.heard(), size).size(), std::size_t{frames});
  const std::uint64_t dropped = link_->counters().ports.frames_dropped;
  EXPECT_GT(dropped, 0U);

  const std::size_t expected = frames - dropped;
  ASSERT_TRUE(run_until([&] { return slow.heard().size() >= expected * size; }));
  const std::vector<int> numbers = frame_numbers(slow.heard(), size);
  EXPECT_EQ(numbers.size(), expected);
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
  EXPECT_LT(expected * size, 128U << 10) << "what waits for a client is bounded";

  // The stream continues with the next frame.
  link_->send(numbered_frame(frames, size));
  ASSERT_TRUE(run_until([&] { return slow.heard().size() == (expected + 1) * size; }));
  EXPECT_EQ(frame_numbers(slow.heard(), size).back(), frames);
}

TEST_F(TcpLink, AClientThatLeftWithoutReadingIsLetGo) {
  Client slow = tcp_client(localhost, /*receive_buffer_bytes=*/4096);
  ASSERT_TRUE(run_until_connections(1));
  while (link_->counters().ports.frames_dropped == 0) {
    link_->send(numbered_frame(0, 1545));
  }
  slow.close();  // with unread bytes, which causes a reset
  EXPECT_TRUE(run_until_left(1));
  EXPECT_FALSE(link_->connected());
}

TEST_F(TcpLink, RefusesOneTooMany) {
  std::vector<std::unique_ptr<Client>> clients;
  for (int i = 0; i < 16; ++i) {
    clients.push_back(std::make_unique<Client>(tcp_client()));
  }
  ASSERT_TRUE(run_until_connections(16));
  Client late = tcp_client();
  EXPECT_TRUE(run_until([&] { return late.closed_by_peer(); }));
  EXPECT_EQ(link_->counters().ports.refused, 1U);
  EXPECT_THAT(left_, IsEmpty()) << "it never was a client";
  clients.pop_back();
  ASSERT_TRUE(run_until_left(1));
  Client next = tcp_client();
  EXPECT_TRUE(run_until_connections(17));
}

/// A link with sixteen clients and a stepped clock.
class FullTcpLink : public LinkTest {
 protected:
  FullTcpLink() {
    open({{any_tcp}, {}, {}, 0}, stepped_);
    for (int i = 0; i < 16; ++i) {
      clients_.push_back(std::make_unique<Client>(tcp_client()));
      EXPECT_TRUE(run_until_connections(static_cast<std::uint64_t>(i) + 1));
    }
  }

  SteppedClock stepped_;
  std::vector<std::unique_ptr<Client>> clients_;
};

TEST_F(FullTcpLink, TheClientThatIsSilentLongestGivesItsPlaceToTheNext) {
  stepped_.time += std::chrono::seconds{10};
  for (std::size_t i = 0; i < clients_.size(); ++i) {
    if (i != 1) {
      clients_[i]->write(send_version);
    }
  }
  ASSERT_TRUE(run_until([&] { return heard_.size() == 15 * send_version.size(); }));
  stepped_.time += std::chrono::seconds{20} - TimePoint{1};
  Client too_early = tcp_client();
  EXPECT_TRUE(run_until([&] { return too_early.closed_by_peer(); }));
  EXPECT_THAT(left_, IsEmpty());

  stepped_.time += TimePoint{1};
  const std::string longest_silent = "tcp " + endpoint_text(clients_[1]->endpoint());
  Client next = tcp_client();
  ASSERT_TRUE(run_until_connections(17));
  EXPECT_TRUE(run_until([&] { return clients_[1]->closed_by_peer(); }));
  EXPECT_THAT(left_, ElementsAre(longest_silent));
  next.write(send_version);
  EXPECT_TRUE(run_until([&] { return heard_.size() == 16 * send_version.size(); }));
  link_->send(alive);
  EXPECT_TRUE(run_until_hears(next, alive));
  EXPECT_TRUE(run_until_hears(*clients_[0], alive)) << "who speaks stays";
}

TEST_F(FullTcpLink, SilenceAloneEndsNoConnection) {
  stepped_.time += std::chrono::hours{24};
  link_->send(alive);
  for (const auto& client : clients_) {
    EXPECT_TRUE(run_until_hears(*client, alive));
  }
}

/// Leaves no free descriptor for this process until the end of the scope.
class NoDescriptors {
 public:
  NoDescriptors() {
    getrlimit(RLIMIT_NOFILE, &before_);
    const int next = dup(STDIN_FILENO);
    close(next);
    const rlimit none{static_cast<rlim_t>(next), before_.rlim_max};
    EXPECT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  }
  ~NoDescriptors() { setrlimit(RLIMIT_NOFILE, &before_); }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;

 private:
  rlimit before_{};
};

TEST_F(TcpLink, OutOfDescriptorsItWaitsAndDoesNotSpin) {
  Client first = tcp_client();
  ASSERT_TRUE(run_until_connections(1));
  Client second = tcp_client();  // connected by the kernel, not accepted yet
  second.write(send_version);
  {
    const NoDescriptors none;
    std::size_t handlers = 0;
    const auto end = std::chrono::steady_clock::now() + milliseconds{300};
    while (std::chrono::steady_clock::now() < end) {
      handlers += io_.run_one_for(milliseconds{10});
      io_.restart();
    }
    EXPECT_LT(handlers, 10U);
    EXPECT_EQ(link_->counters().ports.connections, 1U);
    link_->send(alive);
    EXPECT_TRUE(run_until_hears(first, alive)) << "who is there is served on";
  }
  EXPECT_TRUE(run_until_heard(send_version));
}

TEST_F(TcpLink, NamesTheAddressThatIsTaken) {
  const SerialTcpConfig same{link_->addresses().tcp.at(0), loopback};
  try {
    SerialLink second(io_, {{same}, {}, {}, 0}, clock_);
    FAIL() << "two listeners on one port";
  } catch (const SocketError& error) {
    EXPECT_EQ(error.what(), "cannot bind TCP " + endpoint_text(same.bind) + ": Address already in use");
  }
}

TEST_F(TcpLink, ListensAgainAtOnceAfterAStopWithClients) {
  const SerialTcpConfig same{link_->addresses().tcp.at(0), loopback};
  Client client = tcp_client();
  ASSERT_TRUE(run_until_connections(1));
  link_->stop();
  EXPECT_TRUE(run_until([&] { return client.closed_by_peer(); }));
  link_.reset();
  open({{same}, {}, {}, 0});
  Client next = tcp_client();
  EXPECT_TRUE(run_until_connections(1));
}

TEST_F(LinkTest, TcpServesOnlyWhomItIsAllowedTo) {
  open({{{{localhost, 0}, {{localhost, 32}}}}, {}, {}, 0});
  Client unauthorised = tcp_client(0x7F000009);
  EXPECT_TRUE(run_until([&] { return unauthorised.closed_by_peer(); }));
  EXPECT_EQ(link_->counters().ports.refused, 1U);
  EXPECT_EQ(link_->counters().ports.connections, 0U);
  Client friendly = tcp_client();
  EXPECT_TRUE(run_until_connections(1));
}

}  // namespace
}  // namespace sonard::server
