// SPDX-License-Identifier: Apache-2.0
// The requirements of clients on a head, with one test for each: form of its messages, behaviour, and rates
// (protocol/oculus/README.md 3 to 8).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "protocol/oculus/client.hpp"
#include "protocol/oculus/codec.hpp"
#include "protocol/oculus/device.hpp"
#include "protocol/oculus/recorded_form.hpp"
#include "tests/support/device_bench.hpp"
#include "tests/support/messages.hpp"

namespace sonard::oculus {
namespace {

using Bytes = std::vector<std::uint8_t>;
using std::chrono::milliseconds;
using std::chrono::seconds;

const Peer vehicle{Device::stream_channel, {0xC0A80205, 40000}, 0};

/// A head with one client that reads with a client's code. Images are ready at once.
class Line : public DeviceBench {
 public:
  explicit Line(const DeviceConfig& config = {})
      : DeviceBench(device_, [this](const PingJob& job) { return image_of(job); }),
        device_(config, TimePoint{}) {
    step(TimePassed{});
    step(ClientCame{vehicle});
  }

  void receive(const Bytes& bytes) { DeviceBench::receive(vehicle, bytes); }

  Client client;
  std::vector<ReceivedPing> pings;
  std::vector<Bytes> sent;
  std::vector<Bytes> statuses;
  bool plays_eight_bits = false;
  std::optional<SensorReadings> readings;  ///< at the transmit time of each ping

 protected:
  void hear(const Outgoing& message) override {
    if (message.to == Outgoing::To::everybody) {
      statuses.emplace_back(message.bytes.begin(), message.bytes.end());
      return;
    }
    client.receive(now, message.bytes);
    sent.emplace_back(message.bytes.begin(), message.bytes.end());
    for (ReceivedPing& ping : client.take_pings()) {
      pings.push_back(std::move(ping));
    }
  }

 private:
  /// Samples that count up, so that a misplaced sample is detected.
  PingImage image_of(const PingJob& job) const {
    const auto count = static_cast<std::size_t>(job.bins()) * static_cast<std::size_t>(job.beams);
    PingImage image;
    image.number = job.number;
    image.readings = readings;
    if (job.sixteen_bit && !plays_eight_bits) {
      image.u16.resize(count);
      for (std::size_t i = 0; i < count; ++i) {
        image.u16[i] = static_cast<std::uint16_t>(i * 7919);
      }
    } else {
      image.u8.resize(count);
      for (std::size_t i = 0; i < count; ++i) {
        image.u8[i] = static_cast<std::uint8_t>(i * 31);
      }
    }
    return image;
  }

  Device device_;
};

SimpleFire fire_with(bool second, int bits, bool gains, int beams, int mode) {
  SimpleFire fire;
  fire.version = second ? 2 : 0;
  fire.fire.master_mode = static_cast<std::uint8_t>(mode);
  fire.fire.range = 4.321;
  fire.fire.gamma = 200;
  fire.fire.gain_percent = 30.0;
  fire.fire.salinity_ppt = 35.0;
  fire.fire.flags = static_cast<std::uint8_t>(
      fire_flags::range_in_metres | fire_flags::simple_result | (bits > 8 ? fire_flags::sixteen_bit : 0) |
      (gains ? fire_flags::row_gains : 0) | (beams == 512 ? fire_flags::beams_512 : 0));
  if (second) {
    fire.extension.emplace();
    fire.extension->flags = bits == 32 ? extension_flags::thirty_two_bit : 0;
    fire.extension->reserved[3] = 17;
  }
  return fire;
}

// 3.1, as several clients send them. One client's header states no length; another's states a wrong version.
TEST(OculusAcceptance, FiresOfAllClientsSplitAtEveryByteMakeItPing) {
  for (const char* name : {"fire_vendor", "fire_ensta", "fire_ensta_resume_v2", "fire_liboculus_8_bit",
                           "fire_liboculus_32_bit"}) {
    const Bytes bytes = sonard::testing::message_bytes("oculus", name);
    for (std::size_t cut = 1; cut < bytes.size(); ++cut) {
      Line line;
      const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(cut);
      line.receive({bytes.begin(), middle});
      EXPECT_TRUE(line.jobs.empty()) << name << " " << cut;
      line.receive({middle, bytes.end()});
      ASSERT_EQ(line.jobs.size(), 1U) << name << " " << cut;
    }
    Line line;
    Bytes twice = bytes;
    twice.insert(twice.end(), bytes.begin(), bytes.end());
    line.receive(twice);
    EXPECT_EQ(line.jobs.size(), 1U) << name;
  }
}

using Form = std::tuple<bool, int, bool, int, int>;
class OculusForms : public ::testing::TestWithParam<Form> {};

// 4.1 to 4.4 and 4.7, on the bytes: the checks of vendor code, liboculus and ENSTA's driver.
TEST_P(OculusForms, EchoAndSizesAreWhatClientsCheck) {
  const auto [second, bits, gains, beams, mode] = GetParam();
  const SimpleFire fire = fire_with(second, bits, gains, beams, mode);
  Line line;
  line.receive(encode(fire));
  line.run_for(milliseconds{300});
  ASSERT_GE(line.pings.size(), 3U);
  EXPECT_EQ(line.client.statistics().bad_messages, 0U);
  const PingResult& ping = line.pings[1].result;
  EXPECT_EQ(ping.fire.extension, fire.extension);
  EXPECT_EQ(ping.fire.version, second ? 2 : 1);
  const Fire& echo = ping.fire.fire;
  EXPECT_EQ(echo.master_mode, mode);
  EXPECT_EQ(echo.gamma, 200);
  EXPECT_EQ(echo.flags, fire.fire.flags);
  EXPECT_EQ(echo.range, 4.321);
  EXPECT_EQ(echo.salinity_ppt, 35.0);
  EXPECT_EQ(echo.gain_percent, mode == 1 ? 30.0 : 40.0 + 0.6 * 30.0);
  EXPECT_EQ(echo.sound_speed_mps, ping.sound_speed_mps);
  const std::size_t width = static_cast<std::size_t>(bits) / 8;
  const std::size_t stride = static_cast<std::size_t>(beams) * width + (gains ? 4 : 0);
  EXPECT_EQ(ping.beams, beams);
  EXPECT_EQ(static_cast<std::size_t>(ping.data_size) + 1, width);
  EXPECT_EQ(ping.image_size, ping.ranges * stride);
  EXPECT_EQ(ping.image_offset, 2048U);
  EXPECT_EQ(ping.image_offset + ping.image_size, line.pings[1].message.size());
  EXPECT_EQ(ping.message_size, line.pings[1].message.size());
  EXPECT_LE(ping.ranges * ping.range_resolution_m, 4.321);
  EXPECT_GT((ping.ranges + 1) * ping.range_resolution_m, 4.321);
  // Samples, and the gain word before each row.
  for (const std::size_t row : {std::size_t{0}, std::size_t{1}, std::size_t{ping.ranges} - 1}) {
    if (gains) {
      const auto word = ping.image.subspan(row * stride, 4);
      EXPECT_EQ(Bytes(word.begin(), word.end()), (Bytes{1, 0, 0, 0}));
    }
    for (const std::size_t beam : {std::size_t{0}, std::size_t{5}, static_cast<std::size_t>(beams) - 1}) {
      const std::size_t i = row * static_cast<std::size_t>(beams) + beam;
      std::uint32_t sample = 0;
      for (std::size_t b = 0; b < width; ++b) {
        sample |= std::uint32_t{ping.image[row * stride + (gains ? 4 : 0) + beam * width + b]} << (8 * b);
      }
      const std::uint32_t narrow = static_cast<std::uint8_t>(i * 31);
      const std::uint32_t wide = static_cast<std::uint16_t>(i * 7919);
      EXPECT_EQ(sample, bits == 8 ? narrow : bits == 16 ? wide : wide << 16 | wide) << row << " " << beam;
    }
  }
  // 4.5 and 8: the table for the M750d's aperture at this frequency, whose ends are exact.
  const double half_deg = mode == 1 ? 65.0 : 35.0;
  EXPECT_EQ(ping.bearings_cdeg.front(), -100 * half_deg);
  EXPECT_EQ(ping.bearings_cdeg.back(), 100 * half_deg);
  const double quarter =
      std::asin(std::sin(half_deg * std::numbers::pi / 180) * (2.0 * 64 / (beams - 1) - 1));
  EXPECT_EQ(ping.bearings_cdeg[64], std::trunc(quarter * 18000 / std::numbers::pi));
  EXPECT_EQ(ping.frequency_hz, mode == 1 ? 750e3 : 1.2e6);
}

using ::testing::Bool;
using ::testing::Combine;
using ::testing::Values;
// A request for 32 bits needs the extension.
INSTANTIATE_TEST_SUITE_P(First, OculusForms,
                         Combine(Values(false), Values(8, 16), Bool(), Values(256, 512), Values(1, 2)));
INSTANTIATE_TEST_SUITE_P(Second, OculusForms,
                         Combine(Values(true), Values(8, 16, 32), Bool(), Values(256, 512), Values(1, 2)));

// 8: ranges of the models. A greater requested range is echoed, and the image reaches as far as the head can.
TEST(OculusAcceptance, ModelsHaveRangesAndAperturesOfTheirOwn) {
  EXPECT_EQ(m3000d.part_number, 2203);
  EXPECT_EQ(m370s.part_number, 1041);
  EXPECT_EQ(c550d.part_number, 4713);
  struct Case {
    Model model;
    int mode;
    double range_m, half_deg, frequency_hz;
  };
  for (const Case& it : {Case{m750d, 1, 120.0, 65.0, 750e3}, Case{m750d, 2, 40.0, 35.0, 1.2e6},
                         Case{m1200d, 1, 40.0, 65.0, 1.2e6}, Case{m1200d, 2, 10.0, 30.0, 2098880.597},
                         Case{m3000d, 1, 30.0, 65.0, 1.2e6}, Case{m3000d, 2, 5.0, 20.0, 3e6},
                         Case{m370s, 1, 200.0, 65.0, 375e3}, Case{m370s, 2, 200.0, 65.0, 375e3},
                         Case{c550d, 1, 100.0, 65.0, 550e3}, Case{c550d, 2, 30.0, 35.0, 820e3}}) {
    DeviceConfig config;
    config.plan.model = it.model;
    Line line(config);
    SimpleFire fire = fire_with(false, 8, false, 256, it.mode);
    fire.fire.range = 500.0;
    line.receive(encode(fire));
    line.run_for(milliseconds{400});
    ASSERT_FALSE(line.pings.empty());
    const PingResult& ping = line.pings[0].result;
    EXPECT_EQ(ping.fire.fire.range, 500.0);
    EXPECT_NEAR(ping.ranges * ping.range_resolution_m, it.range_m, ping.range_resolution_m);
    EXPECT_LE(ping.ranges, 1200);
    EXPECT_EQ(ping.bearings_cdeg.back(), 100 * it.half_deg);
    EXPECT_EQ(ping.frequency_hz, it.frequency_hz);
    EXPECT_EQ(line.pings[0].message[14] | line.pings[0].message[15] << 8, it.model.part_number);
  }
}

// 6: 142 bytes once a second, also while a client is connected. Addresses are in the order of their octets.
TEST(OculusAcceptance, AStatusOf142BytesComesEachSecondWhateverElseHappens) {
  Line line;
  line.receive(encode(fire_with(true, 8, true, 512, 1)));
  const std::size_t before = line.statuses.size();
  line.run_for(seconds{20});
  EXPECT_EQ(line.statuses.size() - before, 20U);
  for (const Bytes& status : line.statuses) {
    ASSERT_EQ(status.size(), 142U);
    EXPECT_EQ(Bytes(status.begin() + 52, status.begin() + 56), (Bytes{127, 0, 0, 1}));
    EXPECT_EQ(status[16] | status[17] << 8, status[2] | status[3] << 8) << "the ID of the header";
  }
  EXPECT_EQ(Bytes(line.statuses.back().begin() + 60, line.statuses.back().begin() + 64),
            (Bytes{192, 168, 2, 5}));
  for (const Bytes& message : line.sent) {
    EXPECT_EQ(message[2] | message[3] << 8, 7892) << "the same in every message of the stream";
  }
}

// 7, each section of the diagram.
TEST(OculusAcceptance, IdleAndStandbyAreToldEachSecondAndStandbyEndsWithinAPeriod) {
  Line line;
  EXPECT_EQ(line.client.take_logs().size(), 1U);
  line.run_for(milliseconds{3'100});
  EXPECT_EQ(line.client.statistics().dummies, 3U);
  line.receive(sonard::testing::message_bytes("oculus", "fire_ensta"));
  line.run_for(milliseconds{950});
  EXPECT_EQ(line.pings.size(), 10U);
  line.receive(sonard::testing::message_bytes("oculus", "fire_ensta_standby"));
  EXPECT_EQ(line.client.statistics().dummies, 4U) << "at once: a client waits for it";
  line.run_for(seconds{4});
  EXPECT_LE(line.pings.size(), 11U);
  EXPECT_EQ(line.client.statistics().dummies, 8U);
  const std::size_t in_standby = line.pings.size();
  line.receive(sonard::testing::message_bytes("oculus", "fire_ensta"));
  line.run_for(milliseconds{950});
  EXPECT_GE(line.pings.size(), in_standby + 9);
  EXPECT_EQ(line.client.statistics().pings_missed, 0U) << "numbers count on";
}

// 3.3, and 7: the viewer fires after every ping and every status.
TEST(OculusAcceptance, RatesAreLimitsAlsoWhereEachPingIsAnsweredByTheSameFire) {
  for (const auto& [code, hz] : {std::pair{0, 10}, {1, 15}, {2, 40}, {3, 5}, {4, 2}}) {
    Line line;
    SimpleFire fire = fire_with(false, 8, true, 256, 2);
    fire.fire.range = 2.0;
    fire.fire.ping_rate = static_cast<std::uint8_t>(code);
    line.receive(encode(fire));
    std::size_t answered = 0;
    for (int i = 0; i < 10'000; ++i) {
      line.run_for(milliseconds{1});
      for (; answered < line.pings.size(); ++answered) {
        line.receive(encode(fire));
      }
    }
    EXPECT_NEAR(static_cast<double>(line.pings.size()), 10 * hz, 1.0) << hz << " Hz";
  }
}

// 4.4: a driver waits for its settings in one of the next pings.
TEST(OculusAcceptance, NewSettingsComeWithTheNextPing) {
  Line line;
  line.receive(encode(fire_with(false, 8, true, 256, 1)));
  line.run_for(milliseconds{550});
  const std::size_t before = line.pings.size();
  line.receive(encode(fire_with(false, 8, true, 512, 2)));
  line.run_for(milliseconds{210});
  ASSERT_GE(line.pings.size(), before + 2);
  EXPECT_EQ(line.pings[before + 1].result.fire.fire.master_mode, 2);
  EXPECT_EQ(line.pings[before + 1].result.beams, 512);
}

// 4.1, 4.2: readings at the time when the pulse left.
TEST(OculusAcceptance, APingSaysHowTheHeadIsTurnedAndHowDeepItIs) {
  const SensorReadings readings{.heading_rad = std::numbers::pi / 2,
                                .pitch_rad = -std::numbers::pi / 6,
                                .roll_rad = std::numbers::pi,
                                .depth_m = 20.0};
  for (const bool second : {true, false}) {
    Line line;
    line.readings = readings;
    line.receive(encode(fire_with(second, 8, true, 256, 2)));
    line.run_for(milliseconds{100});
    ASSERT_FALSE(line.pings.empty());
    const auto recorded = recorded_form(line.records.at(0).wire);
    ASSERT_TRUE(recorded);
    for (const PingResult& ping : {line.pings[0].result, *recorded}) {
      EXPECT_NEAR(ping.pressure_bar, 3.013, 1e-9);
      EXPECT_EQ(ping.temperature_c, 20.0);
      EXPECT_NEAR(ping.heading_deg, second ? 90.0 : 0.0, 1e-9);  // version 1 has no attitude
      EXPECT_NEAR(ping.pitch_deg, second ? -30.0 : 0.0, 1e-9);
      EXPECT_NEAR(ping.roll_deg, second ? 180.0 : 0.0, 1e-9);
    }
  }
}

TEST(OculusAcceptance, AStatusSaysHowDeepTheHeadIsWhetherItPingsOrNot) {
  DeviceConfig config;
  config.plan.pressure_bar = 1.7;
  Line line(config);
  const auto told_bar = [&] {
    line.run_for(seconds{1});
    return decode_status(line.statuses.back()).value().pressure_bar;
  };
  EXPECT_EQ(told_bar(), 1.7) << "it has read nothing yet";
  line.step(SensorsRead{{.depth_m = 20.0}});
  EXPECT_NEAR(told_bar(), 3.013, 1e-9);
  line.step(SensorsRead{{.depth_m = -1.0}});
  EXPECT_NEAR(told_bar(), 1.013, 1e-9);
  line.step(SensorsRead{});
  EXPECT_EQ(told_bar(), 1.7);
}

// In simulated time the head pings only when NextPingDue comes, and reports the period that it would use.
TEST(OculusAcceptance, InSimulatedTimeItWaitsForNextPingDue) {
  DeviceConfig config;
  config.simulated_time = true;
  Line line(config);
  EXPECT_FALSE(line.last.next_ping);
  line.receive(encode(fire_with(false, 8, false, 256, 2)));
  line.run_for(seconds{1});
  EXPECT_TRUE(line.jobs.empty());
  ASSERT_TRUE(line.last.next_ping);
  EXPECT_EQ(line.last.next_ping->period, milliseconds{100});
  EXPECT_NEAR(static_cast<double>(line.last.next_ping->listening.count()), 2 * 4.321 / 1522 * 1e9, 1e5);
  line.step(NextPingDue{});
  EXPECT_EQ(line.jobs.size(), 1U);
  line.run_for(seconds{1});
  EXPECT_EQ(line.pings.size(), 1U);
}

// ---- Playback

ReplayedPing fed(const PingRecord& record, std::uint64_t number) {
  return {.record = number,
          .settings = record.settings,
          .bearing_rad = 0.0,
          .bits_per_bin = 8,
          .wire = record.wire,
          .due = std::nullopt};
}

TEST(OculusPlayback, SendsThePingThatItIsFedWhateverIsAskedFor) {
  Line live;
  live.readings = SensorReadings{.heading_rad = std::numbers::pi / 2, .depth_m = 20.0};
  live.receive(encode(fire_with(true, 8, true, 512, 1)));
  live.run_for(milliseconds{100});
  ASSERT_GE(live.records.size(), 1U);
  const PingRecord& record = live.records[0];
  EXPECT_EQ(record.settings.beams, 512);
  EXPECT_EQ(record.settings.gain_percent, 30.0);
  EXPECT_NEAR(record.settings.amplitude_exponent, 200.0 / 255, 1e-12);
  EXPECT_EQ(record.samples.size(), static_cast<std::size_t>(record.settings.bins) * 512);
  EXPECT_EQ(record.samples[5], static_cast<std::uint8_t>(5 * 31));
  EXPECT_EQ(record.wire.size(), result_v2_size + 2 * 512);

  DeviceConfig config;
  config.plays_back = true;
  Line player(config);
  player.plays_eight_bits = true;
  player.readings = SensorReadings{.heading_rad = 1.0, .depth_m = 1.0};  // readings at the place of playback
  player.receive(encode(fire_with(true, 8, true, 512, 1)));
  player.run_for(seconds{1});
  EXPECT_TRUE(player.jobs.empty()) << "nothing was fed";
  player.step(PingFed{fed(record, 77)});
  ASSERT_EQ(player.jobs.size(), 1U);
  EXPECT_EQ(player.jobs[0].record, 77U);
  EXPECT_TRUE(player.jobs[0].differences.empty());
  player.run_for(milliseconds{100});
  ASSERT_EQ(player.pings.size(), 1U);
  const PingResult& sent = player.pings[0].result;
  const PingResult& was = live.pings[0].result;
  EXPECT_EQ(sent.bearings_cdeg, was.bearings_cdeg);
  EXPECT_EQ(sent.range_resolution_m, was.range_resolution_m);
  EXPECT_EQ(sent.frequency_hz, was.frequency_hz);
  EXPECT_NEAR(sent.heading_deg, 90.0, 1e-9);
  EXPECT_NEAR(sent.pressure_bar, 3.013, 1e-9);
  EXPECT_TRUE(std::ranges::equal(sent.image, was.image));

  SimpleFire other = fire_with(true, 16, false, 256, 2);
  other.fire.gain_percent = 80.0;
  other.fire.gamma = 127;
  other.fire.sound_speed_mps = 1450.0;
  player.receive(encode(other));
  player.step(PingFed{fed(record, 78)});
  player.run_for(milliseconds{200});
  ASSERT_EQ(player.pings.size(), 2U);
  std::string kinds;
  for (const Difference& difference : player.jobs[1].differences) {
    kinds += difference.kind + " ";
  }
  EXPECT_EQ(kinds, "beams frequency gain sound_speed gamma bits ");
  const PingResult& held = player.pings[1].result;
  EXPECT_EQ(held.beams, 512);
  EXPECT_NE(held.fire.fire.flags & fire_flags::beams_512, 0) << "what is attached";
  EXPECT_EQ(held.fire.fire.master_mode, 2) << "as the client sent it";
  EXPECT_EQ(held.data_size, DataSize::bits_16);
  EXPECT_EQ(eight_bit_samples(held), record.samples);
  EXPECT_NEAR(player.records.at(1).settings.amplitude_exponent, 200.0 / 255, 1e-12) << "of what was recorded";
}

TEST(OculusPlayback, WhatNoHeadCouldSendHasNoRecordedForm) {
  Line live;
  live.receive(encode(fire_with(false, 8, false, 256, 1)));
  live.run_for(milliseconds{100});
  const Bytes& wire = live.records.at(0).wire;
  EXPECT_TRUE(recorded_form(wire));
  EXPECT_FALSE(recorded_form({}));
  for (std::size_t size = 0; size < wire.size(); ++size) {
    EXPECT_FALSE(recorded_form(std::span(wire).first(size))) << size;
  }
  Bytes other = wire;
  other[6] = 0x55;
  EXPECT_FALSE(recorded_form(other));
  EXPECT_FALSE(recorded_form(sonard::testing::message_bytes("oculus", "ping_result_v1"))) << "four beams";
}

// ---- The client's side

TEST(OculusClient, ReadsMessagesInPiecesOfAnySizeAndCountsWhatIsMissing) {
  Line line;
  line.receive(encode(fire_with(true, 8, true, 256, 1)));
  line.run_for(milliseconds{450});
  Bytes stream{'S', 'S', 'x'};
  for (std::size_t i = 0; i < line.sent.size(); ++i) {
    if (i != 2) {  // one ping is lost on the link
      stream.insert(stream.end(), line.sent[i].begin(), line.sent[i].end());
    }
  }
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, std::size_t{4096}, stream.size()}) {
    Client client;
    for (std::size_t at = 0; at < stream.size(); at += piece) {
      client.receive({}, std::span(stream).subspan(at, std::min(piece, stream.size() - at)));
      if (piece == 1 && at > 5000) {
        break;  // single bytes are slow
      }
    }
    EXPECT_EQ(client.statistics().dropped_bytes, 3U);
    EXPECT_EQ(client.take_logs().size(), 1U);
    if (piece > 1) {
      EXPECT_EQ(client.statistics().pings, line.pings.size() - 1);
      EXPECT_EQ(client.statistics().pings_missed, 1U);
      EXPECT_EQ(client.statistics().bad_messages, 0U);
    }
  }
}

TEST(OculusClient, ALengthThatNoMessageHasIsSkipped) {
  Client client;
  Bytes bytes = encode_dummy({7892, 1032});
  bytes[13] = 0x7F;  // about two billion bytes
  const Bytes good = encode_dummy({7892, 1032});
  bytes.insert(bytes.end(), good.begin(), good.end());
  client.receive({}, bytes);
  EXPECT_EQ(client.statistics().dummies, 1U);
  EXPECT_EQ(client.statistics().dropped_bytes, 16U);
  Bytes bad = sonard::testing::message_bytes("oculus", "ping_result_v1");
  bad[106] = 9;
  client.receive({}, bad);
  EXPECT_EQ(client.statistics().bad_messages, 1U);
  EXPECT_TRUE(client.take_pings().empty());
}

}  // namespace
}  // namespace sonard::oculus
