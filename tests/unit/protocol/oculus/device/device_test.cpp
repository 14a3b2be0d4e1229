// SPDX-License-Identifier: Apache-2.0
// The head from the view of its clients (protocol/oculus/README.md 5, 6, 7).
#include "protocol/oculus/device.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/oculus/codec.hpp"
#include "tests/support/device_bench.hpp"
#include "tests/support/messages.hpp"

namespace sonard::oculus {
namespace {

using Bytes = std::vector<std::uint8_t>;
using std::chrono::milliseconds;
using std::chrono::seconds;

const Peer client{Device::stream_channel, {0xC0A80205, 40000}, 0};
const Peer second_client{Device::stream_channel, {0xC0A80206, 40001}, 0};

/// A head with a record of everything that it sent.
class Bench : public DeviceBench {
 public:
  explicit Bench(const DeviceConfig& config = {})
      : DeviceBench(device, [](const PingJob& job) { return test_image(job, job.bins(), 256); }),
        device(config, TimePoint{}) {
    step(TimePassed{});
  }

  void connect(const Peer& who = client) { step(ClientCame{who}); }
  void receive(const Bytes& bytes, const Peer& from = client) { DeviceBench::receive(from, bytes); }
  std::size_t count(MessageId id) const {
    return static_cast<std::size_t>(std::ranges::count_if(stream, [&](const Bytes& bytes) {
      return bytes.size() >= 16 && (bytes[6] | bytes[7] << 8) == static_cast<int>(id);
    }));
  }

  Device device;
  std::vector<Bytes> stream;
  std::vector<Bytes> statuses;

 protected:
  void hear(const Outgoing& message) override {
    (message.to == Outgoing::To::everybody ? statuses : stream)
        .emplace_back(message.bytes.begin(), message.bytes.end());
  }
};

SimpleFire fire_at(std::uint8_t rate) {
  SimpleFire fire;
  fire.fire.ping_rate = rate;
  return fire;
}

TEST(OculusDevice, SendsAStatusOf142BytesEachSecond) {
  Bench bench;
  bench.run_for(milliseconds{10'500});
  EXPECT_EQ(bench.statuses.size(), 11U);
  for (const Bytes& bytes : bench.statuses) {
    const Status status = decode_status(bytes).value();
    EXPECT_EQ(status.address, (std::array<std::uint8_t, 4>{127, 0, 0, 1}));
    EXPECT_EQ(status.client, (std::array<std::uint8_t, 4>{}));
    EXPECT_EQ(status.status, 3U);
  }
}

TEST(OculusDevice, AMoveOfTheServerIsInTheNextStatus) {
  Bench bench;
  bench.device.move_to(0x0A3D13C9, 0xFFFFFF00);
  bench.run_for(seconds{1});
  const Status status = decode_status(bench.statuses.back()).value();
  EXPECT_EQ(status.address, (std::array<std::uint8_t, 4>{10, 61, 19, 201}));
  EXPECT_EQ(status.netmask, (std::array<std::uint8_t, 4>{255, 255, 255, 0}));
}

std::uint64_t count_of(const Device& device, std::string_view name) {
  const std::vector<Counter> counts = device.counts();
  return std::ranges::find(counts, name, &Counter::name)->value;
}

TEST(OculusDevice, WarnsOnceOfEachFieldOfAFireThatItChanges) {
  Bench bench;
  bench.connect();
  bench.receive(encode(fire_at(0)));
  EXPECT_EQ(count_of(bench.device, "out_of_range"), 0U);
  const std::size_t before = bench.notices.size();
  const auto fire_with = [&](const auto& change) {
    SimpleFire fire = fire_at(0);
    change(fire.fire);
    for (int i = 0; i < 2; ++i) {
      bench.receive(encode(fire));
    }
  };
  fire_with([](Fire& fire) { fire.range = 40.5; });  // the high frequency reaches 40 m
  fire_with([](Fire& fire) { fire.gain_percent = 101.0; });
  fire_with([](Fire& fire) { fire.sound_speed_mps = 150.0; });
  fire_with([](Fire& fire) { fire.master_mode = 0; });
  fire_with([](Fire& fire) { fire.ping_rate = 6; });
  EXPECT_EQ(count_of(bench.device, "out_of_range"), 10U);
  std::vector<std::string> texts;
  for (std::size_t i = before; i < bench.notices.size(); ++i) {
    EXPECT_EQ(bench.notices[i].level, Notice::Level::warning);
    texts.push_back(bench.notices[i].text);
  }
  EXPECT_EQ(texts, (std::vector<std::string>{
                       "the client's range in metres 40.5 is out of range: the head uses 0.1 to 40",
                       "the client's gainPercent 101 is out of range: the head uses 0 to 100",
                       "the client's speedOfSound 150 is out of range: the head uses 1400 to 1600",
                       "the client's masterMode 0 is unknown: the head uses 2, the high frequency",
                       "the client's pingRate 6 is unknown: the head uses 0, 10 pings per second"}));
}

TEST(OculusDevice, AHeadWithOneFrequencyWarnsOfAFireForAnother) {
  DeviceConfig config;
  config.plan.model = m370s;
  Bench bench(config);
  bench.connect();
  SimpleFire fire = fire_at(0);
  fire.fire.master_mode = 2;
  bench.receive(encode(fire));
  ASSERT_FALSE(bench.notices.empty());
  EXPECT_EQ(bench.notices.back().text, "the client's masterMode 2 is not 1: this head has one frequency");
  EXPECT_EQ(count_of(bench.device, "out_of_range"), 1U);
}

TEST(OculusDevice, LimitsOfARangeAreThoseOfTheFrequencyInMetresOrPercent) {
  Bench bench;
  bench.connect();
  SimpleFire fire = fire_at(0);
  fire.fire.range = 40.5;
  fire.fire.master_mode = 1;  // the low frequency reaches 120 m
  bench.receive(encode(fire));
  fire.fire.flags &= static_cast<std::uint8_t>(~fire_flags::range_in_metres);
  bench.receive(encode(fire));
  EXPECT_EQ(count_of(bench.device, "out_of_range"), 0U);
  fire.fire.range = 100.5;
  bench.receive(encode(fire));
  EXPECT_EQ(count_of(bench.device, "out_of_range"), 1U);
}

TEST(OculusDevice, CountsFullResultsUnknownMessagesShortFiresAndBytesOutside) {
  Bench bench;
  bench.connect();
  SimpleFire fire = fire_at(0);
  fire.fire.flags &= static_cast<std::uint8_t>(~fire_flags::simple_result);
  bench.receive(encode(fire));
  EXPECT_EQ(count_of(bench.device, "full_results_requested"), 1U);
  EXPECT_EQ(bench.notices.back().text, "the client requests the full result (0x22): sonard sends 0x23");
  Bytes message = encode(UserConfig{});
  message[6] = 0x31;
  bench.receive(message);
  EXPECT_EQ(count_of(bench.device, "unknown_id"), 1U);
  message[6] = 0xFF;  // a Dummy, which a viewer could send too
  bench.receive(message);
  EXPECT_EQ(count_of(bench.device, "unknown_id"), 1U);
  Bytes short_fire = encode(fire_at(0));
  short_fire[10] = 36;
  short_fire.resize(16 + 36);
  bench.receive(short_fire);
  EXPECT_EQ(count_of(bench.device, "bad_commands"), 1U);
  bench.receive({1, 2, 3, 4});
  EXPECT_EQ(count_of(bench.device, "dropped_bytes"), 4U);
}

TEST(OculusDevice, StatusFollowsTheClientAtOnce) {
  Bench bench;
  bench.connect();
  EXPECT_EQ(decode_status(bench.statuses.back())->client, (std::array<std::uint8_t, 4>{192, 168, 2, 5}));
  bench.step(ClientGone{client});
  EXPECT_EQ(decode_status(bench.statuses.back())->client, (std::array<std::uint8_t, 4>{}));
  EXPECT_EQ(bench.statuses.size(), 3U);
}

TEST(OculusDevice, GreetsWithALogAndThenDummies) {
  Bench bench;
  bench.connect();
  EXPECT_EQ(bench.count(MessageId::logs), 1U);
  bench.run_for(milliseconds{5'500});
  EXPECT_EQ(bench.count(MessageId::dummy), 5U);
  EXPECT_EQ(bench.count(MessageId::simple_ping_result), 0U);
}

TEST(OculusDevice, OneFirePingsOnAtItsRate) {
  for (const auto& [rate, pings] : {std::pair{0, 100U}, {1, 150U}, {2, 400U}, {3, 50U}, {4, 20U}}) {
    Bench bench;
    bench.connect();
    bench.receive(encode(fire_at(static_cast<std::uint8_t>(rate))));
    bench.run_for(milliseconds{9'999});
    EXPECT_NEAR(static_cast<double>(bench.count(MessageId::simple_ping_result)), pings, 1.0) << rate;
    EXPECT_EQ(bench.count(MessageId::dummy), 0U);
  }
}

TEST(OculusDevice, TheSameFireAgainChangesNothing) {
  Bench bench;
  bench.connect();
  for (int i = 0; i < 999; ++i) {
    bench.receive(encode(fire_at(0)));
    bench.run_for(milliseconds{10});
  }
  EXPECT_EQ(bench.count(MessageId::simple_ping_result), 100U);
}

TEST(OculusDevice, StandbyStopsPingsWithADummyAndAFireResumes) {
  Bench bench;
  bench.connect();
  bench.receive(encode(fire_at(1)));
  bench.run_for(seconds{1});
  const std::size_t before = bench.count(MessageId::simple_ping_result);
  bench.receive(encode(fire_at(5)));
  bench.run_for(milliseconds{3'500});
  EXPECT_EQ(bench.count(MessageId::simple_ping_result), before);
  EXPECT_EQ(bench.count(MessageId::dummy), 4U);
  bench.receive(encode(fire_at(1)));
  bench.run_for(seconds{1});
  EXPECT_GT(bench.count(MessageId::simple_ping_result), before + 13);
}

TEST(OculusDevice, PingIdsCountUpAndTheIdIsThatOfTheStatus) {
  Bench bench;
  bench.connect();
  bench.receive(encode(fire_at(1)));
  bench.run_for(seconds{1});
  std::uint32_t before = 0;
  for (const Bytes& bytes : bench.stream) {
    EXPECT_EQ(bytes[2] | bytes[3] << 8, 7892);
    if (const auto ping = decode_ping_result(bytes)) {
      EXPECT_EQ(ping->ping_id, before + 1);
      before = ping->ping_id;
    }
  }
  EXPECT_GE(before, 14U);
}

TEST(OculusDevice, ASecondClientIsClosed) {
  Bench bench;
  bench.connect();
  bench.connect(second_client);
  EXPECT_EQ(bench.last.disconnect, std::vector<Peer>{second_client});
  bench.receive(encode(fire_at(5)), second_client);
  bench.step(ClientGone{second_client});
  bench.receive(encode(fire_at(0)));
  bench.run_for(seconds{1});
  EXPECT_GE(bench.count(MessageId::simple_ping_result), 9U);
}

TEST(OculusDevice, ASilentClientWithoutPingsGivesItsPlaceToTheNext) {
  Bench bench;
  bench.connect();
  bench.run_for(Device::most_silence - milliseconds{1});
  bench.connect(second_client);
  EXPECT_EQ(bench.last.disconnect, std::vector<Peer>{second_client}) << "it is not silent for long";
  bench.receive(Bytes(15, 0x4F));  // shorter than a message
  bench.run_for(milliseconds{1});
  bench.connect(second_client);
  EXPECT_EQ(bench.last.disconnect, std::vector<Peer>{client});
  bench.step(ClientGone{client});
  bench.receive(encode(fire_at(0)), second_client);
  bench.run_for(seconds{1});
  EXPECT_GE(bench.count(MessageId::simple_ping_result), 9U);
}

// Most drivers fire once and then only receive.
TEST(OculusDevice, AClientThatPingsKeepsItsPlaceHoweverLongItOnlyListens) {
  Bench bench;
  bench.connect();
  bench.receive(encode(fire_at(4)));
  bench.run_for(std::chrono::minutes{10});
  bench.connect(second_client);
  EXPECT_EQ(bench.last.disconnect, std::vector<Peer>{second_client});
}

TEST(OculusDevice, ACommandOf5000BytesClosesTheConnection) {
  Bench bench;
  bench.connect();
  Bytes bytes = encode(fire_at(0));
  bytes[11] = 0x20;
  bench.receive(bytes);
  EXPECT_EQ(bench.last.disconnect, std::vector<Peer>{client});
}

TEST(OculusDevice, UserConfigIsAnsweredAndRemembered) {
  Bench bench;
  bench.connect();
  bench.receive(sonard::testing::message_bytes("oculus", "user_config_request"));
  EXPECT_EQ(bench.count(MessageId::user_config), 1U);
  const UserConfig other{{10, 0, 0, 9}, {255, 0, 0, 0}, 0};
  bench.receive(encode(other));
  bench.receive(encode(UserConfig{}));
  EXPECT_TRUE(*decode_command(bench.stream.back()) == Command{other});
}

TEST(OculusDevice, RefusesAnIdOfZero) {
  DeviceConfig config;
  config.id = 0;
  EXPECT_THROW(Device(config, TimePoint{}), std::invalid_argument);
}

}  // namespace
}  // namespace sonard::oculus
