// SPDX-License-Identifier: Apache-2.0
// Files `.sonar`: pings for replay, and what `sonard info` says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "protocol/sonar3d15/imu.hpp"
#include "protocol/sonar3d15/shot.hpp"
#include "server/devices/types/types.hpp"
#include "server/error/error.hpp"
#include "tests/unit/server/logs/temporary_log.hpp"

namespace sonard::server {
namespace {

using Bytes = std::vector<std::uint8_t>;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;
namespace wire = sonar3d15;

constexpr std::int64_t first_ns = 1'767'225'600'250'000'000;

/// Both packets of a shot of 4 by 2 pixels with one echo, at 6 m: RIP1 if its number is odd, else RIP2.
std::array<Bytes, 2> shot(std::uint32_t number) {
  wire::DeviceConfig config;
  config.columns = 4;
  config.rows = 2;
  config.gain = 1e6;
  wire::Settings settings;
  settings.range_m = 15.0;
  wire::Shot made = wire::make_shot(config, settings, 1500.0);
  DirectionRanges echoes{4, 2, std::vector<float>(8), std::vector<float>(8)};
  echoes.range_m[5] = 6.0F;
  echoes.intensity[5] = 1e-6F;  // a strength of 1000
  wire::add_echoes(echoes, config, 0.3, made);
  wire::set_header(std::chrono::nanoseconds{first_ns + number * 200'000'000LL}, number, made);
  const wire::PacketId id = number % 2 == 1 ? wire::PacketId::rip1 : wire::PacketId::rip2;
  return {wire::encode(made.range, id), wire::encode(made.signal, id)};
}

Bytes joined(std::initializer_list<Bytes> parts) {
  Bytes all;
  for (const Bytes& part : parts) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

Bytes batch() {
  return wire::encode(wire::make_imu_batch(0, 2, std::chrono::nanoseconds{first_ns}, {}, {}, {}),
                      wire::PacketId::rip2);
}

TEST(Sonar3d15Log, HoldsTheShotsOfBothImages) {
  const auto a = shot(0), b = shot(1);
  const test::TemporaryLog log(".sonar", joined({a[0], a[1], batch(), b[0], b[1]}));
  const LogFile file(log.path());
  EXPECT_EQ(name_of(file.kind()), ".sonar");
  const auto reader = open_log(file, &open_packet_log);
  ASSERT_EQ(reader->heads().size(), 1U);
  const LoggedHead& head = reader->heads()[0];
  EXPECT_EQ(head.type, "sonar3d15");
  ASSERT_EQ(head.pings.size(), 2U);
  EXPECT_EQ(head.pings[0].time_ns, first_ns);
  EXPECT_EQ(head.pings[1].time_ns, first_ns + 200'000'000);
  EXPECT_EQ(head.pings[0].wire, joined({a[0], a[1]}));
  EXPECT_EQ(head.pings[1].wire, joined({b[0], b[1]}));
  EXPECT_EQ(head.bearings_rad.size(), 4U);
  const Bytes samples = reader->samples(head.pings[1]);
  ASSERT_EQ(samples.size(), 4U * wire::fan_bins);
  const auto bin = static_cast<std::size_t>(5.99 / (15.0 / wire::fan_bins));
  EXPECT_EQ(samples[bin * 4 + 1], 152);  // column 1: 100 log10(1000 / 30)
  EXPECT_THAT(reader->problems(), ElementsAre());
  EXPECT_EQ(type_named("sonar3d15")->why_not_played(head), std::nullopt);
}

TEST(Sonar3d15Log, SaysWhatIsNotAPing) {
  const auto a = shot(0), b = shot(1), c = shot(2);
  Bytes damaged = b[1];
  damaged[20] ^= 1;
  const test::TemporaryLog log(".sonar",
                               joined({a[0], a[1], b[0], damaged, c[0], a[1], c[1], batch(), batch()}));
  const LogSummary summary = summarise(LogFile(log.path()), &ping_in, &open_packet_log);
  ASSERT_EQ(summary.heads.size(), 1U);
  EXPECT_EQ(summary.heads[0].pings(), 1U);
  EXPECT_EQ(summary.closed, std::nullopt);
  EXPECT_THAT(summary.other_records,
              ElementsAre(Pair("images without the other one of their shot", 4U), Pair("IMU batches", 2U)));
  EXPECT_THAT(summary.problems, ElementsAre(HasSubstr("the packets in them are lost")));
}

TEST(Sonar3d15Log, ReadsOnAfterDamageAtItsStart) {
  const auto a = shot(0);
  const test::TemporaryLog log(".sonar", joined({{0, 0, 0, 0, 0}, a[0], a[1]}));
  const LogFile file(log.path());
  EXPECT_EQ(open_log(file, &open_packet_log)->heads().at(0).pings.size(), 1U);
}

TEST(Sonar3d15Log, OfNoPacketIsRefused) {
  const test::TemporaryLog log(".sonar", Bytes{'R', 'I', 'P', '2', 0, 0});
  const LogFile file(log.path());
  EXPECT_THROW(open_log(file, &open_packet_log), Error);
}

}  // namespace
}  // namespace sonard::server
