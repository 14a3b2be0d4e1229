// SPDX-License-Identifier: Apache-2.0
// MAVLink over UDP on loopback, with frames from tests/support/mavlink_bytes.hpp.
#include "server/pose/mavlink/source.hpp"

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
using test::Bytes;
using test::operator+;
using testing::HasSubstr;

class MavlinkPoseSourceTest : public SourceTest {
 protected:
  std::unique_ptr<MavlinkPoseSource> started(AllowList allow = loopback) {
    MavlinkPoseInput input;
    input.bind = {localhost, 0};
    input.allow = std::move(allow);
    auto source = std::make_unique<MavlinkPoseSource>(io_, std::move(input), clock_, sink_);
    source->start();
    return source;
  }

  void send(const MavlinkPoseSource& to, const Bytes& datagram, Ipv4 from = localhost) {
    udp::socket socket{io_, {address_v4{from}, 0}};
    socket.send_to(boost::asio::buffer(datagram), {address_v4{localhost}, to.local_endpoint().port});
  }
};

TEST_F(MavlinkPoseSourceTest, DeliversPosesOfBothKindsAndVersions) {
  const auto source = started();
  EXPECT_FALSE(source->publisher());
  send(*source, test::heartbeat_frame() + test::attitude_frame(1000, 0, 0, 0, {1}) +
                    test::position_frame(1000, 1, 2, 3));
  send(*source, test::odometry_frame(5'000'000, 4, 5, 6));
  ASSERT_TRUE(run_until_delivered(2));
  EXPECT_NEAR(delivered_[0].sample.T_world_vehicle.position_m.x, 2, 1e-9);
  EXPECT_NEAR(delivered_[0].sample.T_world_vehicle.position_m.y, 1, 1e-9);
  EXPECT_NEAR(delivered_[1].sample.T_world_vehicle.position_m.z, -6, 1e-9);
  EXPECT_EQ(source->counters().samples, 2U);
  EXPECT_THAT(source->details(), HasSubstr(" messages=4 bad_checksums=0 "));
  ASSERT_TRUE(source->publisher());
  EXPECT_EQ(to_string(*source->publisher()),
            endpoint_text(source->publisher()->endpoint) + " system 1 component 1");
  EXPECT_EQ(source->publisher()->endpoint.address, localhost);
}

TEST_F(MavlinkPoseSourceTest, DropsAndCountsWhatIsBrokenOrOfOthers) {
  const auto source = started();
  Bytes broken = test::odometry_frame(1, 1, 1, 1);
  broken.back() ^= 1;
  send(*source, broken);
  send(*source, {'h', 'i'});
  send(*source, {});
  send(*source, test::odometry_frame(1, 1, 1, 1, 1, {2, 9, 1}));
  send(*source, test::odometry_frame(1, 1, 1, 1, 1, {2, 1, 197}));
  send(*source, test::odometry_frame(1, 1, 1, 1, 4));
  send(*source, test::odometry_frame(2, 1, 1, 1));
  ASSERT_TRUE(run_until_delivered(1));
  EXPECT_EQ(delivered_.size(), 1U);
  EXPECT_EQ(source->counters().malformed, 2U);
  EXPECT_THAT(source->details(),
              testing::AllOf(HasSubstr(" bad_checksums=1 "), HasSubstr(" wrong_system=1 "),
                             HasSubstr(" wrong_component=1 "), HasSubstr(" unknown_frame=1 ")));
}

// A world without a place on Earth, and a vehicle without a fix: nothing is missing but two seconds.
TEST_F(MavlinkPoseSourceTest, TakesTheDepthOfAVehicleWithoutAPlaceAndAsksForNoOrigin) {
  const auto source = started();
  std::uint32_t time_ms = 1000;
  const auto deliver = [&] {
    time_ms += 20;
    send(*source, test::attitude_frame(time_ms, 0, 0, 0) + test::depth_frame(time_ms, 0, -12'500));
    return run_until([&] { return !delivered_.empty(); }, milliseconds{20});
  };
  EXPECT_FALSE(deliver());
  EXPECT_THAT(source->silence_hint(), testing::AllOf(HasSubstr("gives only a depth"), HasSubstr("2 s"),
                                                     testing::Not(HasSubstr("world.origin"))));
  EXPECT_TRUE(test::wait_for(deliver));
  ASSERT_FALSE(delivered_.empty());
  EXPECT_NEAR(delivered_[0].sample.T_world_vehicle.position_m.z, -12.5, 1e-9);
  EXPECT_THAT(source->remark(), HasSubstr("has a depth but no position"));
}

TEST_F(MavlinkPoseSourceTest, AnAttitudeAloneIsNotNothing) {
  const auto source = started();
  EXPECT_THAT(source->silence_hint(), testing::StartsWith("nothing arrived: is the publisher running"));
  send(*source, test::attitude_frame(1000, 0, 0, 0, {1}));
  ASSERT_TRUE(run_until([&] {
    return source->silence_hint() ==
           "messages of the vehicle arrive, but no positions with attitudes: "
           "request them (docs/simulators/ardusub.md)";
  }));
  EXPECT_EQ(source->unreadable(clock_.now()), "") << "an attitude alone is no fault";
}

TEST_F(MavlinkPoseSourceTest, TellsOfMessagesThatCannotBeRead) {
  const auto source = started();
  send(*source, {'h', 'i'});
  ASSERT_TRUE(run_until([&] { return source->counters().malformed == 1; }));
  EXPECT_THAT(source->unreadable(clock_.now()), testing::AllOf(HasSubstr("1 message from 127.0.0.1:"),
                                                               HasSubstr("not a valid MAVLink frame.")));
}

TEST_F(MavlinkPoseSourceTest, ListensOnlyToWhomItIsAllowed) {
  const auto source = started({{localhost, 32}});
  send(*source, test::odometry_frame(1, 1, 1, 1), 0x7F000009);
  send(*source, test::odometry_frame(2, 2, 2, 2));
  ASSERT_TRUE(run_until_delivered(1));
  EXPECT_NEAR(delivered_[0].sample.T_world_vehicle.position_m.x, 2, 1e-9);
  EXPECT_EQ(source->counters().refused, 1U);
}

TEST_F(MavlinkPoseSourceTest, NamesItselfAndWhatTheOsRefuses) {
  const auto first = started();
  EXPECT_EQ(first->description(),
            "pose mavlink udp " + endpoint_text(first->local_endpoint()) + " system 1 component 1");
  MavlinkPoseInput input;
  input.bind = first->local_endpoint();
  MavlinkPoseSource second{io_, input, clock_, sink_};
  try {
    second.start();
    FAIL() << "two sockets on one port";
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), "pose mavlink udp: cannot bind UDP " + endpoint_text(first->local_endpoint()) +
                                ": Address already in use");
  }
}

TEST_F(MavlinkPoseSourceTest, MayBeStoppedByItsOwnSinkInTheMiddleOfADatagram) {
  std::unique_ptr<MavlinkPoseSource> source;
  sink_ = [&](const pose::PoseSample& sample, TimePoint arrival) {
    delivered_.push_back({sample, arrival});
    source->stop();
  };
  source = started();
  send(*source, test::odometry_frame(1, 1, 1, 1) + test::odometry_frame(2, 1, 1, 1));
  ASSERT_TRUE(run_until_delivered(1));
  run_for(milliseconds{50});
  EXPECT_EQ(delivered_.size(), 1U);
}

TEST_F(MavlinkPoseSourceTest, MayBeDestroyedWithAHandlerWaiting) {
  for (int i = 0; i < 200; ++i) {
    auto source = started();
    send(*source, test::odometry_frame(1, 1, 1, 1));
    source.reset();
    io_.restart();
    io_.poll();
  }
  EXPECT_TRUE(delivered_.empty());
}

}  // namespace
}  // namespace sonard::server
