// SPDX-License-Identifier: Apache-2.0
// Poses over UDP on loopback.
#include "server/pose/udp/source.hpp"

#include <gmock/gmock.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/udp.hpp>

#include "server/net/addresses.hpp"
#include "tests/support/mavlink_bytes.hpp"
#include "tests/unit/server/pose/source_fixture.hpp"

namespace sonard::server {
namespace {

using boost::asio::ip::address_v4;
using boost::asio::ip::udp;
using std::chrono::milliseconds;
using test::operator+;
using testing::HasSubstr;

class UdpPoseSourceTest : public SourceTest {
 protected:
  std::unique_ptr<UdpPoseSource> started(AllowList allow = loopback) {
    auto source =
        std::make_unique<UdpPoseSource>(io_, UdpPoseInput{{localhost, 0}, std::move(allow)}, clock_, sink_);
    source->start();
    return source;
  }

  void send(const UdpPoseSource& to, const std::vector<std::uint8_t>& datagram, Ipv4 from = localhost) {
    udp::socket socket{io_, {address_v4{from}, 0}};
    socket.send_to(boost::asio::buffer(datagram), {address_v4{localhost}, to.local_endpoint().port});
  }
};

TEST_F(UdpPoseSourceTest, DeliversEachDatagramWithItsArrival) {
  const auto source = started();
  const TimePoint before = clock_.now();
  for (int i = 0; i < 20; ++i) {
    send(*source, pose::encode(sample(i)));
  }
  ASSERT_TRUE(run_until_delivered(20));
  for (int i = 0; i < 20; ++i) {
    const auto& delivery = delivered_[static_cast<std::size_t>(i)];
    EXPECT_EQ(delivery.sample.time_ns, i);
    EXPECT_GE(delivery.arrival, before);
    EXPECT_LE(delivery.arrival, clock_.now());
  }
  EXPECT_EQ(source->counters().samples, 20U);
}

TEST_F(UdpPoseSourceTest, DropsAndCountsWhatIsNoPose) {
  const auto source = started();
  send(*source, {'h', 'e', 'l', 'l', 'o'});
  send(*source, pose::encode(nan_sample()));
  send(*source, {});  // an empty datagram is a message without a vehicle
  send(*source, pose::encode(sample(1)));
  ASSERT_TRUE(run_until_delivered(1));
  EXPECT_EQ(delivered_.size(), 1U);
  EXPECT_EQ(source->counters().malformed, 1U);
  EXPECT_EQ(source->counters().bad_value, 2U);
}

TEST_F(UdpPoseSourceTest, TellsOfMessagesThatCannotBeRead) {
  const auto source = started();
  EXPECT_EQ(source->unreadable(clock_.now()), "");
  udp::socket socket{io_, {address_v4{localhost}, 0}};
  const auto send = [&](const std::vector<std::uint8_t>& datagram) {
    socket.send_to(boost::asio::buffer(datagram), {address_v4{localhost}, source->local_endpoint().port});
  };
  send({'h', 'e', 'l', 'l', 'o'});
  send(pose::encode(nan_sample()));
  send(pose::encode(sample(1)));
  ASSERT_TRUE(run_until_delivered(1));
  EXPECT_EQ(source->unreadable(clock_.now()),
            "2 messages from 127.0.0.1:" + std::to_string(socket.local_endpoint().port()) +
                " could not be read: message: is not a PoseUpdate (pose.proto).");
  EXPECT_EQ(source->unreadable(clock_.now() + std::chrono::minutes{2}), "") << "it is over";
}

TEST_F(UdpPoseSourceTest, KnowsMavlinkAndNamesItsKey) {
  for (const test::Bytes& frames :
       {test::heartbeat_frame(), test::attitude_frame(1000, 0, 0, 0, {1}) + test::heartbeat_frame()}) {
    const auto source = started();
    send(*source, frames);
    ASSERT_TRUE(run_until([&] { return !source->unreadable(clock_.now()).empty(); }));
    EXPECT_THAT(source->unreadable(clock_.now()), HasSubstr("looks like MAVLink: configure poses.mavlink"));
  }
}

TEST_F(UdpPoseSourceTest, TakesTheLongestDatagram) {
  const auto source = started();
  pose::PoseSample large = sample(1);
  const std::size_t around_name = [&] {
    large.bodies = {{std::string(60'000, 'n'), {}}};
    return pose::encode(large).size() - 60'000;
  }();
  large.bodies[0].name = std::string(pose::max_message_bytes - around_name, 'n');
  ASSERT_EQ(pose::encode(large).size(), pose::max_message_bytes);
  send(*source, pose::encode(large));
  ASSERT_TRUE(run_until_delivered(1));
  EXPECT_EQ(delivered_[0].sample.bodies[0].name, large.bodies[0].name);
}

TEST_F(UdpPoseSourceTest, ListensOnlyToWhomItIsAllowed) {
  const auto source = started({{localhost, 32}});
  send(*source, pose::encode(sample(1)), 0x7F000009);
  send(*source, pose::encode(sample(2)));
  ASSERT_TRUE(run_until_delivered(1));
  EXPECT_EQ(delivered_[0].sample.time_ns, 2);
  EXPECT_EQ(source->counters().refused, 1U);
}

TEST_F(UdpPoseSourceTest, NamesAddressAndOperationWhenTheOsRefuses) {
  const auto first = started();
  UdpPoseSource second{io_, {first->local_endpoint(), loopback}, clock_, sink_};
  try {
    second.start();
    FAIL() << "two sockets on one port";
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), "pose stream udp: cannot bind UDP " + endpoint_text(first->local_endpoint()) +
                                ": Address already in use");
  }
}

TEST_F(UdpPoseSourceTest, NamesItselfWithThePortOfTheKernel) {
  UdpPoseSource source{io_, {{localhost, 0}, loopback}, clock_, sink_};
  EXPECT_EQ(source.description(), "pose stream udp 127.0.0.1:0");
  source.start();
  EXPECT_NE(source.local_endpoint().port, 0);
  EXPECT_EQ(source.description(), "pose stream udp " + endpoint_text(source.local_endpoint()));
}

TEST_F(UdpPoseSourceTest, IsSilentOnceStopped) {
  const auto source = started();
  send(*source, pose::encode(sample(1)));
  source->stop();
  run_for(milliseconds{50});
  EXPECT_TRUE(delivered_.empty());
}

TEST_F(UdpPoseSourceTest, MayBeStoppedByItsOwnSink) {
  std::unique_ptr<UdpPoseSource> source;
  sink_ = [&](const pose::PoseSample& sample, TimePoint arrival) {
    delivered_.push_back({sample, arrival});
    source->stop();
  };
  source = started();
  send(*source, pose::encode(sample(1)));
  send(*source, pose::encode(sample(2)));
  ASSERT_TRUE(run_until_delivered(1));
  run_for(milliseconds{50});
  EXPECT_EQ(delivered_.size(), 1U);
}

TEST_F(UdpPoseSourceTest, MayBeDestroyedWithAHandlerWaiting) {
  for (int i = 0; i < 1000; ++i) {
    auto source = started();
    send(*source, pose::encode(sample(i)));
    source.reset();
    io_.restart();
    io_.poll();
  }
  EXPECT_TRUE(delivered_.empty());
}

}  // namespace
}  // namespace sonard::server
