// SPDX-License-Identifier: Apache-2.0
// All ports of a link together, and stopping the link at any time.
#include <system_error>
#include <thread>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>

#include "tests/support/wait_for.hpp"
#include "tests/unit/server/net/link_fixture.hpp"

namespace sonard::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class AllPorts : public LinkTest {
 protected:
  static inline const SerialLinkConfig everything{{any_tcp, any_tcp}, {any_udp}, {{}, {}}, 0};

  void stop_ends_all_work() {
    link_->stop();
    const std::size_t left = left_.size();
    const std::size_t heard = heard_.size();
    io_.restart();
    io_.run_for(std::chrono::seconds{10});
    EXPECT_TRUE(io_.stopped()) << "something still waits";
    EXPECT_EQ(left_.size(), left);
    EXPECT_EQ(heard_.size(), heard);
  }
};

TEST_F(AllPorts, ShareOneLine) {
  open(everything);
  const SerialAddresses where = link_->addresses();
  ASSERT_EQ(where.tcp.size(), 2U);
  ASSERT_EQ(where.pty.size(), 2U);
  EXPECT_THAT(
      link_->descriptions(),
      ElementsAre("tcp " + endpoint_text(where.tcp[0]), "tcp " + endpoint_text(where.tcp[1]),
                  "udp " + endpoint_text(where.udp.at(0)), "pty " + where.pty[0], "pty " + where.pty[1]));
  std::vector<Client> clients;
  clients.push_back(Client::tcp(where.tcp[0]));
  clients.push_back(Client::tcp(where.tcp[1]));
  clients.push_back(Client::udp(where.udp[0]));
  clients.push_back(Client::tty(where.pty[0]));
  clients.push_back(Client::tty(where.pty[1]));
  Bytes expected;
  for (std::size_t i = 0; i < clients.size(); ++i) {
    const Bytes said{static_cast<std::uint8_t>(i), 0x40};
    expected.insert(expected.end(), said.begin(), said.end());
    clients[i].write(said);
    ASSERT_TRUE(run_until_heard(expected)) << i;
  }
  EXPECT_EQ(link_->counters().ports.connections, 5U);
  link_->send(alive);
  for (Client& client : clients) {
    EXPECT_TRUE(run_until_hears(client, alive));
  }
}

TEST_F(AllPorts, ACallbackMayAnswer) {
  link_ = std::make_unique<SerialLink>(io_, everything, clock_);
  link_->start(
      [&](std::span<const std::uint8_t> bytes, const std::string&) {
        link_->send({bytes.begin(), bytes.end()});
      },
      [](const std::string&) {});
  Client client = tcp_client();
  client.write(send_version);
  EXPECT_TRUE(run_until_hears(client, send_version));
}

TEST_F(AllPorts, StopEndsEverythingUnderWay) {
  SerialLinkConfig slow_line = everything;
  slow_line.baud = 300;
  for (const SerialLinkConfig& config : {everything, slow_line}) {
    heard_.clear();
    open(config);
    Client reader = tcp_client(localhost, /*receive_buffer_bytes=*/4096);
    Client tty = tty_client();
    Client datagrams = udp_client();
    reader.write(Bytes{0x40});
    datagrams.write(Bytes{0x40});
    tty.write(Bytes{0x40});
    ASSERT_TRUE(run_until([&] { return heard_.size() == 3; }));
    for (int i = 0; i < 300; ++i) {
      link_->send(numbered_frame(i, 1545));  // until both have the first part of a frame in their queue
    }
    stop_ends_all_work();
    EXPECT_FALSE(link_->connected());
    link_->send(alive);
    EXPECT_TRUE(reader.closed_by_peer());
  }
}

TEST_F(AllPorts, MayBeStoppedBeforeItsStart) {
  link_ = std::make_unique<SerialLink>(io_, everything, clock_);
  stop_ends_all_work();
}

TEST_F(AllPorts, MayBeStoppedByItsOwnCallbacks) {
  int received = 0;
  link_ = std::make_unique<SerialLink>(io_, everything, clock_);
  link_->start(
      [&](std::span<const std::uint8_t>, const std::string&) {
        ++received;
        link_->stop();
      },
      [](const std::string&) { FAIL() << "stopped"; });
  Client one = tcp_client();
  Client two = tty_client();
  one.write(send_version);
  two.write(send_version);
  one.close();
  ASSERT_TRUE(run_until([&] { return received > 0; }));
  io_.restart();
  io_.run_for(std::chrono::seconds{10});
  EXPECT_TRUE(io_.stopped());
  EXPECT_EQ(received, 1);
}

TEST_F(AllPorts, MayBeDestroyedByItsOwnCallbacks) {
  for (int round = 0; round < 6; ++round) {
    link_ = std::make_unique<SerialLink>(io_, everything, clock_);
    const bool by_departure = round % 2 == 1;
    link_->start(
        [&](std::span<const std::uint8_t>, const std::string&) {
          if (!by_departure) {
            link_.reset();
          }
        },
        [&](const std::string&) { link_.reset(); });
    std::vector<Client> clients;
    clients.push_back(round / 2 == 0 ? tcp_client() : round / 2 == 1 ? tty_client() : udp_client());
    clients.back().write(send_version);
    if (round / 2 == 2) {
      clients.push_back(udp_client());  // a second datagram peer replaces the first
      clients.back().write(send_version);
    } else {
      clients.back().close();
    }
    EXPECT_TRUE(run_until([&] { return link_ == nullptr; })) << round;
  }
}

TEST_F(AllPorts, MayBeDestroyedWithHandlersWaiting) {
  for (int i = 0; i < 50; ++i) {
    open(everything);
    Client client = tcp_client();
    Client tty = tty_client();
    client.write(send_version);
    if (i % 2 == 0) {
      ASSERT_TRUE(run_until([&] { return !heard_.empty(); }));
    }
    link_.reset();
    heard_.clear();
    io_.restart();
    io_.poll();
    EXPECT_THAT(heard_, IsEmpty());
  }
}

// Clients on other threads, which connect and disconnect until the link is closed.
void come_and_go(const std::function<Client()>& connect) {
  try {
    for (std::size_t i = 0; i < 100; ++i) {
      Client client = connect();
      client.try_write(std::span(send_version).first(1 + i % send_version.size()));
      client.heard();
    }
  } catch (const std::system_error&) {
    return;  // the link is closed
  }
}

// The I/O runs on its own thread, as in the daemon. This is a test for the thread sanitizer.
TEST_F(AllPorts, ServeClientsOfOtherThreadsUntilTheyAreStopped) {
  auto guard = boost::asio::make_work_guard(io_);
  link_ = std::make_unique<SerialLink>(io_, everything, clock_);
  link_->start(
      [&](std::span<const std::uint8_t> bytes, const std::string&) {
        link_->send({bytes.begin(), bytes.end()});
      },
      [](const std::string&) {});
  const SerialAddresses where = link_->addresses();
  Client first = tcp_client();
  std::thread io_thread([this] { io_.run(); });
  std::thread tcp_clients([&] { come_and_go([&] { return Client::tcp(where.tcp[0]); }); });
  std::thread tty_clients([&] { come_and_go([&] { return Client::tty(where.pty[0]); }); });
  come_and_go([&] { return Client::udp(where.udp[0]); });
  first.write(send_version);
  EXPECT_TRUE(test::wait_for([&] { return !first.heard().empty(); }));
  boost::asio::post(io_, [this] { link_->stop(); });
  guard.reset();
  tcp_clients.join();
  tty_clients.join();
  io_thread.join();
  const SerialLinkCounters counters = link_->counters();
  EXPECT_GT(counters.ports.connections, 0U);
  EXPECT_GT(counters.ports.bytes_in, 0U);
}

}  // namespace
}  // namespace sonard::server
