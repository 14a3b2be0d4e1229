// SPDX-License-Identifier: Apache-2.0
#include "server/net/udp_endpoint.hpp"

#include <memory>

#include <gtest/gtest.h>
#include <boost/asio/io_context.hpp>

namespace sonard::server {
namespace {

namespace asio = boost::asio;

constexpr Ipv4 loopback_1 = 0x7F000001;
constexpr Ipv4 loopback_5 = 0x7F000005;

using Bytes = std::vector<std::uint8_t>;

Datagram to(const Endpoint& remote, Bytes bytes, Ipv4 local = 0) {
  return {remote, local, SharedBytes(std::move(bytes))};
}

Bytes bytes_of(const Datagram& datagram) {
  return {datagram.bytes.begin(), datagram.bytes.end()};
}

// Fixture for two endpoints on one io_context that the test runs.
struct UdpEndpointTest : testing::Test {
  asio::io_context io;
  std::vector<Datagram> received;

  UdpEndpoint::Receive collect() {
    return [this](const Datagram& datagram) { received.push_back(datagram); };
  }

  // Runs the I/O until the condition holds. Returns false if it does not hold within ten seconds.
  bool run_until(const std::function<bool()>& done) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{10};
    while (!done() && std::chrono::steady_clock::now() < deadline) {
      io.run_one_for(std::chrono::milliseconds{20});
      io.restart();
    }
    return done();
  }
};

TEST_F(UdpEndpointTest, TellsOnWhichAddressItWasAddressed) {
  UdpEndpoint everywhere(io, {0, 0});
  everywhere.start(collect());
  UdpEndpoint sender(io, {loopback_1, 0});
  const std::uint16_t port = everywhere.local_endpoint().port;
  sender.send({to({loopback_5, port}, {1, 2, 3}), to({loopback_1, port}, {4})});
  ASSERT_TRUE(run_until([&] { return received.size() == 2; }));
  EXPECT_EQ(received[0].local, loopback_5);
  EXPECT_EQ(received[0].remote, sender.local_endpoint());
  EXPECT_EQ(bytes_of(received[0]), (Bytes{1, 2, 3}));
  EXPECT_EQ(received[1].local, loopback_1);
}

TEST_F(UdpEndpointTest, SharesItsPortOnlyWhereAllSaySo) {
  using Sharing = UdpEndpoint::Sharing;
  const UdpEndpoint first(io, {loopback_5, 0}, Sharing::with_others);
  const Endpoint same = first.local_endpoint();
  EXPECT_NO_THROW(UdpEndpoint(io, same, Sharing::with_others));
  EXPECT_THROW(UdpEndpoint(io, same), SocketError);
}

TEST_F(UdpEndpointTest, TakesADatagramWithoutBytes) {
  UdpEndpoint everywhere(io, {0, 0});
  everywhere.start(collect());
  UdpEndpoint sender(io, {loopback_1, 0});
  sender.send({to({loopback_1, everywhere.local_endpoint().port}, {})});
  ASSERT_TRUE(run_until([&] { return received.size() == 1; }));
  EXPECT_TRUE(bytes_of(received[0]).empty());
}

TEST_F(UdpEndpointTest, SendsFromTheAddressAskedFor) {
  UdpEndpoint everywhere(io, {0, 0});
  UdpEndpoint peer(io, {loopback_1, 0});
  peer.start(collect());
  everywhere.send({to(peer.local_endpoint(), {9}, loopback_5)});
  ASSERT_TRUE(run_until([&] { return received.size() == 1; }));
  EXPECT_EQ(received[0].remote, (Endpoint{loopback_5, everywhere.local_endpoint().port}));
}

TEST_F(UdpEndpointTest, BurstLargerThanTheSocketBufferArrivesInOrder) {
  UdpEndpoint receiver(io, {loopback_1, 0});
  receiver.start(collect());
  UdpEndpoint sender(io, {loopback_1, 0});
  bool drained = false;
  std::vector<Datagram> told;
  sender.start([](const Datagram&) {}, [&] { drained = true; },
               [&](std::span<const Datagram> sent) { told.insert(told.end(), sent.begin(), sent.end()); });
  // The receiver reads on the same thread, so the test sends portions that fit the receiver's buffer.
  constexpr int portions = 40;
  constexpr int portion_size = 64;
  for (int portion = 0; portion < portions; ++portion) {
    std::vector<Datagram> burst;
    for (int i = 0; i < portion_size; ++i) {
      const int number = portion * portion_size + i;
      Bytes bytes(272);
      bytes[0] = static_cast<std::uint8_t>(number & 0xFF);
      bytes[1] = static_cast<std::uint8_t>(number >> 8);
      burst.push_back(to(receiver.local_endpoint(), std::move(bytes)));
    }
    sender.send(std::move(burst));
    const std::size_t expected = static_cast<std::size_t>((portion + 1) * portion_size);
    ASSERT_TRUE(run_until([&] { return received.size() == expected; })) << "portion " << portion;
  }
  for (std::size_t i = 0; i < received.size(); ++i) {
    ASSERT_EQ(received[i].bytes[0] | received[i].bytes[1] << 8, static_cast<int>(i));
  }
  EXPECT_EQ(sender.counters().sent, received.size());
  EXPECT_FALSE(sender.blocked());
  ASSERT_EQ(told.size(), received.size());  // in order, each once
  for (std::size_t i = 0; i < told.size(); ++i) {
    ASSERT_EQ(told[i].bytes[0] | told[i].bytes[1] << 8, static_cast<int>(i));
  }
}

TEST_F(UdpEndpointTest, AddressInUseIsAnErrorThatNamesIt) {
  UdpEndpoint first(io, {loopback_1, 0});
  try {
    UdpEndpoint second(io, first.local_endpoint());
    FAIL() << "no exception";
  } catch (const SocketError& error) {
    EXPECT_NE(std::string(error.what()).find("127.0.0.1:" + std::to_string(first.local_endpoint().port)),
              std::string::npos)
        << error.what();
  }
}

TEST_F(UdpEndpointTest, UnreachableDestinationCostsOneDatagramOnly) {
  UdpEndpoint peer(io, {loopback_1, 0});
  peer.start(collect());
  UdpEndpoint sender(io, {loopback_1, 0});
  // From a loopback source the kernel refuses to send to an outside host (EINVAL).
  sender.send({to({0x08080808, 9}, {1}), to(peer.local_endpoint(), {2})});
  ASSERT_TRUE(run_until([&] { return received.size() == 1; }));
  EXPECT_EQ(bytes_of(received[0]), (Bytes{2}));
  EXPECT_EQ(sender.counters().send_failed, 1u);
}

TEST_F(UdpEndpointTest, TooLongDatagramIsCountedAndDropped) {
  UdpEndpoint receiver(io, {loopback_1, 0});
  receiver.start(collect());
  UdpEndpoint sender(io, {loopback_1, 0});
  sender.send({to(receiver.local_endpoint(), Bytes(5000)), to(receiver.local_endpoint(), {7})});
  ASSERT_TRUE(run_until([&] { return received.size() == 1; }));
  EXPECT_EQ(bytes_of(received[0]), (Bytes{7}));
  EXPECT_EQ(receiver.counters().truncated, 1u);
}

TEST_F(UdpEndpointTest, MayBeClosedFromItsOwnCallback) {
  auto receiver = std::make_unique<UdpEndpoint>(io, Endpoint{loopback_1, 0});
  int calls = 0;
  receiver->start([&](const Datagram&) {
    ++calls;
    receiver->close();
  });
  UdpEndpoint sender(io, {loopback_1, 0});
  sender.send({to(receiver->local_endpoint(), {1}), to(receiver->local_endpoint(), {2})});
  ASSERT_TRUE(run_until([&] { return calls == 1; }));
  receiver.reset();
  io.run_for(std::chrono::milliseconds{20});
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace sonard::server
