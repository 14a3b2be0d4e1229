// SPDX-License-Identifier: Apache-2.0
// Poses over TCP on loopback: good publishers, slow publishers and garbage.
#include "server/pose/tcp/source.hpp"

#include <gmock/gmock.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>

#include "server/net/addresses.hpp"
#include "tests/support/mavlink_bytes.hpp"
#include "tests/unit/server/pose/source_fixture.hpp"

namespace sonard::server {
namespace {

using boost::asio::ip::address_v4;
using boost::asio::ip::tcp;
using boost::system::error_code;
using Bytes = std::vector<std::uint8_t>;
using std::chrono::milliseconds;

class TcpPoseSourceTest : public SourceTest {
 protected:
  std::unique_ptr<TcpPoseSource> started(TcpPoseInput input = {{localhost, 0}, loopback, 8},
                                         milliseconds timeout = std::chrono::seconds{5}) {
    auto source = std::make_unique<TcpPoseSource>(io_, std::move(input), clock_, sink_, PoseHold{}, timeout);
    source->start();
    return source;
  }

  tcp::socket connect(const TcpPoseSource& to, Ipv4 from = localhost) {
    tcp::socket socket{io_};
    socket.open(tcp::v4());
    socket.bind({address_v4{from}, 0});
    socket.connect({address_v4{localhost}, to.local_endpoint().port});
    return socket;
  }
  static void send(tcp::socket& socket, std::span<const std::uint8_t> bytes) {
    error_code ignored;  // the source may have closed
    boost::asio::write(socket, boost::asio::buffer(bytes.data(), bytes.size()), ignored);
  }
  /// Runs the I/O until the source has closed this connection.
  bool closed_by_source(tcp::socket& socket) {
    socket.non_blocking(true);
    return run_until([&] {
      std::array<std::uint8_t, 1> byte{};
      error_code error;
      socket.read_some(boost::asio::buffer(byte), error);
      return error && error != boost::asio::error::would_block;
    });
  }
  static Bytes frames(int count) {
    Bytes stream;
    for (int i = 0; i < count; ++i) {
      const Bytes frame = pose::encode_frame(sample(i));
      stream.insert(stream.end(), frame.begin(), frame.end());
    }
    return stream;
  }
};

TEST_F(TcpPoseSourceTest, DeliversMessagesSentInOnePiece) {
  const auto source = started();
  tcp::socket publisher = connect(*source);
  send(publisher, frames(50));
  ASSERT_TRUE(run_until_delivered(50));
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(delivered_[static_cast<std::size_t>(i)].sample.time_ns, i);
  }
  EXPECT_EQ(source->counters().samples, 50U);
  EXPECT_EQ(source->client_count(), 1U);
}

TEST_F(TcpPoseSourceTest, DeliversMessagesSentByteByByte) {
  const auto source = started();
  tcp::socket publisher = connect(*source);
  publisher.set_option(tcp::no_delay{true});
  const Bytes stream = frames(3);
  for (std::size_t i = 0; i < stream.size(); ++i) {
    send(publisher, std::span{stream}.subspan(i, 1));
    io_.restart();
    io_.poll();
  }
  ASSERT_TRUE(run_until_delivered(3));
  EXPECT_EQ(delivered_.size(), 3U);
}

TEST_F(TcpPoseSourceTest, AMessageArrivesWithItsLastByte) {
  const auto source = started();
  tcp::socket publisher = connect(*source);
  const Bytes stream = frames(1);
  send(publisher, std::span{stream}.first(stream.size() - 1));
  run_for(milliseconds{30});
  EXPECT_TRUE(delivered_.empty());
  send(publisher, std::span{stream}.last(1));
  EXPECT_TRUE(run_until_delivered(1));
}

TEST_F(TcpPoseSourceTest, TakesTheLongestMessage) {
  const auto source = started();
  tcp::socket publisher = connect(*source);
  pose::PoseSample large = sample(7);
  large.bodies = {{std::string(65'000, 'n'), {}}};
  const Bytes frame = pose::encode_frame(large);
  Bytes stream = frame;
  stream.insert(stream.end(), frame.begin(), frame.end());
  send(publisher, stream);
  ASSERT_TRUE(run_until_delivered(2));
  EXPECT_EQ(delivered_[1].sample.bodies[0].name.size(), 65'000U);
}

TEST_F(TcpPoseSourceTest, SeveralPublishersAtOnce) {
  const auto source = started();
  tcp::socket one = connect(*source);
  tcp::socket other = connect(*source);
  send(one, pose::encode_frame(sample(1)));
  ASSERT_TRUE(run_until_delivered(1));
  send(other, pose::encode_frame(sample(2)));
  ASSERT_TRUE(run_until_delivered(2));
  EXPECT_EQ(source->client_count(), 2U);
  one.close();
  EXPECT_TRUE(run_until([&] { return source->client_count() == 1; }));
  send(other, pose::encode_frame(sample(3)));
  EXPECT_TRUE(run_until_delivered(3));
  EXPECT_EQ(source->counters().connections, 2U);
  EXPECT_EQ(source->counters().closed, 0U) << "leaving is no fault";
}

TEST_F(TcpPoseSourceTest, ClosesAPeerWithAnImpossibleLength) {
  const auto source = started();
  tcp::socket publisher = connect(*source);
  send(publisher, Bytes{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF});
  EXPECT_TRUE(closed_by_source(publisher));
  EXPECT_EQ(source->counters().malformed, 1U);
  EXPECT_EQ(source->counters().closed, 1U);
  EXPECT_EQ(source->client_count(), 0U);
}

TEST_F(TcpPoseSourceTest, ClosesAPeerThatSpeaksAnotherProtocol) {
  const auto source = started();
  tcp::socket publisher = connect(*source);
  const std::string request =
      "GET / HTTP/1.1\r\nHost: sonard\r\nUser-Agent: somebody's browser, which says a lot\r\n\r\n";
  send(publisher, Bytes(request.begin(), request.end()));
  EXPECT_TRUE(closed_by_source(publisher));
  EXPECT_TRUE(delivered_.empty());
}

TEST_F(TcpPoseSourceTest, DeliversWhatCameBeforeTheGarbage) {
  const auto source = started();
  tcp::socket publisher = connect(*source);
  Bytes stream = frames(2);
  stream.insert(stream.end(), {0xFF, 0xFF, 0xFF});
  send(publisher, stream);
  EXPECT_TRUE(closed_by_source(publisher));
  EXPECT_EQ(delivered_.size(), 2U);
}

TEST_F(TcpPoseSourceTest, ABadValueCostsTheMessageOnly) {
  const auto source = started();
  tcp::socket publisher = connect(*source);
  send(publisher, pose::encode_frame(nan_sample()));
  send(publisher, pose::encode_frame(sample(5)));
  ASSERT_TRUE(run_until_delivered(1));
  EXPECT_EQ(delivered_[0].sample.time_ns, 5);
  EXPECT_EQ(source->counters().bad_value, 1U);
  EXPECT_EQ(source->client_count(), 1U);
}

TEST_F(TcpPoseSourceTest, ClosesAPeerThatLeavesAMessageUnfinished) {
  const auto source = started({{localhost, 0}, loopback, 8}, milliseconds{60});
  tcp::socket slow = connect(*source);
  tcp::socket idle = connect(*source);
  send(idle, frames(1));
  pose::PoseSample large = sample(1);
  large.bodies = {{std::string(1000, 'n'), {}}};
  const Bytes message = pose::encode_frame(large);
  // More bytes of the unfinished message do not extend its deadline.
  const auto began = std::chrono::steady_clock::now();
  std::size_t sent = 0;
  EXPECT_TRUE(run_until([&] {
    send(slow, std::span{message}.subspan(sent++, 1));
    std::this_thread::sleep_for(milliseconds{10});
    return source->counters().closed == 1 || sent == message.size() - 1;
  }));
  EXPECT_GE(std::chrono::steady_clock::now() - began, milliseconds{50});
  EXPECT_LT(sent, 20U);
  EXPECT_TRUE(closed_by_source(slow));
  EXPECT_EQ(source->client_count(), 1U) << "silence between messages is no fault";
  EXPECT_EQ(delivered_.size(), 1U);
}

// A heartbeat of MAVLink 2 begins like a message of 1277 bytes.
TEST_F(TcpPoseSourceTest, KnowsMavlinkAndNamesItsKey) {
  const auto source = started({{localhost, 0}, loopback, 8}, milliseconds{50});
  tcp::socket vehicle = connect(*source);
  send(vehicle, test::heartbeat_frame());
  ASSERT_TRUE(closed_by_source(vehicle));
  EXPECT_THAT(source->unreadable(clock_.now()),
              testing::HasSubstr("looks like MAVLink: configure poses.mavlink"));
}

TEST_F(TcpPoseSourceTest, RefusesOneTooMany) {
  const auto source = started({{localhost, 0}, loopback, 2});
  tcp::socket one = connect(*source);
  tcp::socket two = connect(*source);
  ASSERT_TRUE(run_until([&] { return source->client_count() == 2; }));
  tcp::socket three = connect(*source);
  EXPECT_TRUE(closed_by_source(three));
  EXPECT_EQ(source->counters().refused, 1U);
  one.close();
  ASSERT_TRUE(run_until([&] { return source->client_count() == 1; }));
  tcp::socket four = connect(*source);
  send(four, pose::encode_frame(sample(4)));
  EXPECT_TRUE(run_until_delivered(1));
}

TEST_F(TcpPoseSourceTest, ASilentPublisherGivesItsPlaceToTheNextWhenAllAreTaken) {
  struct : Clock {
    TimePoint time{std::chrono::hours{1}};
    TimePoint now() const override { return time; }
  } clock;
  TcpPoseSource source{io_, {{localhost, 0}, loopback, 2}, clock, sink_};
  source.start();
  tcp::socket silent = connect(source);
  ASSERT_TRUE(run_until([&] { return source.client_count() == 1; }));
  tcp::socket paused = connect(source);
  ASSERT_TRUE(run_until([&] { return source.client_count() == 2; }));
  clock.time += TcpPoseSource::most_silence - TimePoint{1};
  send(paused, pose::encode_frame(sample(1)));
  ASSERT_TRUE(run_until_delivered(1));
  tcp::socket early = connect(source);
  EXPECT_TRUE(closed_by_source(early));

  clock.time += TimePoint{1};
  tcp::socket next = connect(source);
  EXPECT_TRUE(closed_by_source(silent));
  send(next, pose::encode_frame(sample(2)));
  send(paused, pose::encode_frame(sample(3)));
  EXPECT_TRUE(run_until_delivered(3));
}

TEST_F(TcpPoseSourceTest, ListensOnlyToWhomItIsAllowed) {
  const auto source = started({{localhost, 0}, {{localhost, 32}}, 8});
  tcp::socket unauthorised = connect(*source, 0x7F000009);
  EXPECT_TRUE(closed_by_source(unauthorised));
  EXPECT_EQ(source->counters().refused, 1U);
  EXPECT_EQ(source->client_count(), 0U);
}

TEST_F(TcpPoseSourceTest, NamesAddressAndOperationWhenTheOsRefuses) {
  const auto first = started();
  TcpPoseSource second{io_, {first->local_endpoint(), loopback, 8}, clock_, sink_};
  try {
    second.start();
    FAIL() << "two listeners on one port";
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), "pose stream tcp: cannot bind TCP " + endpoint_text(first->local_endpoint()) +
                                ": Address already in use");
  }
}

TEST_F(TcpPoseSourceTest, StopEndsEverything) {
  const auto source = started();
  tcp::socket publisher = connect(*source);
  ASSERT_TRUE(run_until([&] { return source->client_count() == 1; }));
  send(publisher, frames(1));
  source->stop();
  EXPECT_EQ(source->client_count(), 0U);
  EXPECT_TRUE(closed_by_source(publisher));
  EXPECT_TRUE(delivered_.empty());
}

TEST_F(TcpPoseSourceTest, MayBeStoppedByItsOwnSink) {
  std::unique_ptr<TcpPoseSource> source;
  sink_ = [&](const pose::PoseSample& sample, TimePoint arrival) {
    delivered_.push_back({sample, arrival});
    source->stop();
  };
  source = started();
  tcp::socket publisher = connect(*source);
  send(publisher, frames(5));
  ASSERT_TRUE(run_until_delivered(1));
  run_for(milliseconds{30});
  EXPECT_EQ(delivered_.size(), 1U);
}

TEST_F(TcpPoseSourceTest, AThousandConnectionsLeaveNothingBehind) {
  const auto source = started();
  for (int i = 0; i < 1000; ++i) {
    tcp::socket publisher = connect(*source);
    send(publisher, pose::encode_frame(sample(i)));
    publisher.close();
    ASSERT_TRUE(run_until([&] { return source->counters().samples == static_cast<std::uint64_t>(i + 1); }));
  }
  EXPECT_TRUE(run_until([&] { return source->client_count() == 0; }));
  EXPECT_EQ(source->counters().connections, 1000U);
}

TEST_F(TcpPoseSourceTest, MayBeDestroyedWithHandlersWaiting) {
  const Bytes stream = frames(2);
  for (int i = 0; i < 200; ++i) {
    auto source = started();
    tcp::socket publisher = connect(*source);
    // The second message stays unfinished, so a timer waits too.
    send(publisher, std::span{stream}.first(stream.size() - 1));
    if (i % 2 == 0) {
      ASSERT_TRUE(run_until_delivered(1));
    }
    source.reset();
    delivered_.clear();
    io_.restart();
    io_.poll();
    EXPECT_TRUE(delivered_.empty());
  }
}

}  // namespace
}  // namespace sonard::server
