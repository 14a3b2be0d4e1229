// SPDX-License-Identifier: Apache-2.0
// The messages of tests/data/oculus in both directions: bytes to values, and values to bytes.
#include <gtest/gtest.h>

#include "protocol/oculus/layout.hpp"
#include "tests/support/message_fields.hpp"
#include "tests/unit/protocol/oculus/codec/fixture.hpp"

namespace sonard::oculus::testing {
namespace {

using sonard::testing::Json;
using sonard::testing::Message;
using sonard::testing::message_of;
using sonard::testing::set;
using sonard::testing::take;
using sonard::testing::take_fields;

/// The fire that the fields describe. Takes the header, too.
SimpleFire fire_of(Json& fields) {
  SimpleFire fire;
  set(fire.version, take(fields, "header").at("msgVersion"));
  take_fields<FireLayout>(fields, "fire", fire.fire);
  if (fields.contains("fire_extension")) {
    take_fields<FireExtensionLayout>(fields, "fire_extension", fire.extension.emplace());
  }
  return fire;
}

std::vector<Message> fires() {
  auto all = sonard::testing::messages_of("oculus");
  std::erase_if(all, [](const Message& example) { return example.message != "simple_fire"; });
  return all;
}

class OculusFire : public ::testing::TestWithParam<Message> {};

TEST_P(OculusFire, BytesAndFieldsMeanTheSame) {
  const Message& example = GetParam();
  Json fields = example.fields;
  const SimpleFire fire = fire_of(fields);
  EXPECT_TRUE(fields.empty()) << fields;
  const auto command = decode_command(example.bytes);
  ASSERT_TRUE(command) << to_string(command.error());
  EXPECT_TRUE(*command == Command{fire});
  if (example.is_written) {
    EXPECT_EQ(encode(fire), example.bytes);
  }
}
INSTANTIATE_TEST_SUITE_P(all, OculusFire, ::testing::ValuesIn(fires()), sonard::testing::message_name);

template <class Member>
void expect_same(const PingResult& found, const PingResult& wanted, const Field<PingResult, Member>& field) {
  EXPECT_EQ(found.*field.member, wanted.*field.member) << field.name;
}
template <std::size_t Size>
void expect_same(const PingResult&, const PingResult&, const Spare<Size>&) {}

template <class Table>
void expect_result(const std::string& name, const std::string& group) {
  SCOPED_TRACE(name);
  const Message& example = message_of("oculus", name);
  Json fields = example.fields;
  PingResult wanted;
  wanted.fire = fire_of(fields);
  take_fields<Table>(fields, group, wanted);
  set(wanted.image, take(fields, "image"));
  const Bytes bearings = sonard::testing::bytes_of(take(fields, "bearings"));
  for (std::size_t i = 0; i < bearings.size(); i += 2) {
    wanted.bearings_cdeg.push_back(static_cast<std::int16_t>(bearings[i] | bearings[i + 1] << 8));
  }
  EXPECT_TRUE(fields.empty()) << fields;
  EXPECT_EQ(encode(wanted, m1200d), example.bytes);

  const auto ping = decode_ping_result(example.bytes);
  ASSERT_TRUE(ping) << to_string(ping.error());
  EXPECT_TRUE(ping->fire == wanted.fire);
  std::apply([&](const auto&... field) { (expect_same(*ping, wanted, field), ...); }, Table::fields);
  EXPECT_EQ(ping->bearings_cdeg, wanted.bearings_cdeg);
  EXPECT_TRUE(std::ranges::equal(ping->image, wanted.image));
  EXPECT_EQ(encode(*ping, m1200d), example.bytes);
}

TEST(OculusExamples, ResultsOfBothVersions) {
  expect_result<ResultV1Layout>("ping_result_v1", "result_v1");
  expect_result<ResultV2Layout>("ping_result_v2", "result_v2");
}

TEST(OculusExamples, StatusBothWays) {
  Json fields = message_of("oculus", "status").fields;
  Status status;
  take_fields<StatusLayout>(fields, "status", status);
  EXPECT_EQ(encode(status, m1200d), load_fixture("status"));
  EXPECT_TRUE(decode_status(load_fixture("status")).value() == status);
}

TEST(OculusExamples, HeadersOfAllMessages) {
  for (const Message& example : sonard::testing::messages_of("oculus")) {
    Json fields = example.fields;
    Header described;
    take_fields<HeaderLayout>(fields, "header", described);
    Header found;
    ByteReader reader{example.bytes};
    read_fields<HeaderLayout>(reader, found);
    EXPECT_TRUE(found == described) << example.name;
  }
}

// The fields above reach their members by the codec's tables. These values are read off the document.
TEST(OculusExamples, MembersHoldTheFieldsOfTheirNames) {
  const Fire fire = std::get<SimpleFire>(*decode_command(load_fixture("fire_vendor"))).fire;
  EXPECT_TRUE(fire == (Fire{1, 0, 255, 127, 0x49, 10.0, 20.0, 0.0, 35.0}));
  const Fire standby = std::get<SimpleFire>(*decode_command(load_fixture("fire_ensta_standby"))).fire;
  EXPECT_TRUE(standby == (Fire{2, 5, 255, 127, 0x0D, 5.0, 80.0, 1500.0, 0.0}));

  const auto common = [](const PingResult& ping) {
    return std::tuple(ping.ping_id, ping.frequency_hz, ping.temperature_c, ping.pressure_bar,
                      ping.sound_speed_mps, ping.range_resolution_m, ping.ranges, ping.image_offset);
  };
  constexpr double step_m = 1500.0 / (2.0 * 37.5e6 / 143.0);
  const Bytes bytes_v1 = load_fixture("ping_result_v1");
  const PingResult v1 = decode_ping_result(bytes_v1).value();
  EXPECT_EQ(common(v1), std::tuple(42U, 750e3, 18.5, 1.25, 1500.0, step_m, 3, 136U));
  EXPECT_EQ(v1.start_time_ns, 123'456'789U);
  EXPECT_EQ(v1.bearings_cdeg, (std::vector<std::int16_t>{-6500, -1757, 1757, 6500}));
  const Bytes bytes_v2 = load_fixture("ping_result_v2");
  const PingResult v2 = decode_ping_result(bytes_v2).value();
  EXPECT_EQ(common(v2), std::tuple(43U, 2.1e6, 18.5, 1.25, 1500.0, step_m, 3, 216U));
  EXPECT_EQ(std::tuple(v2.heading_deg, v2.pitch_deg, v2.roll_deg, v2.start_time_s, v2.data_size),
            std::tuple(90.0, -1.5, 2.5, 12.345678, DataSize::bits_16));
  EXPECT_EQ(v2.bearings_cdeg, (std::vector<std::int16_t>{-3000, -959, 959, 3000}));

  const Status status = decode_status(load_fixture("status")).value();
  EXPECT_EQ(std::tuple(status.device_id, status.part_number, status.pressure_bar),
            std::tuple(7892U, 1042, 1.25));
  EXPECT_EQ(status.address, (std::array<std::uint8_t, 4>{192, 168, 2, 4}));
  EXPECT_EQ(status.netmask, (std::array<std::uint8_t, 4>{255, 255, 255, 0}));
}

/// A ping with this value in every floating-point field.
PingResult ping_of(double value, bool second_version) {
  PingResult ping;
  ping.fire.fire.range = ping.fire.fire.gain_percent = value;
  ping.fire.fire.sound_speed_mps = ping.fire.fire.salinity_ppt = value;
  if (second_version) {
    ping.fire.extension = FireExtension{};
  }
  ping.frequency_hz = ping.temperature_c = ping.pressure_bar = value;
  ping.heading_deg = ping.pitch_deg = ping.roll_deg = value;
  ping.sound_speed_mps = ping.start_time_s = ping.range_resolution_m = value;
  ping.image_offset = 2048;
  return ping;
}

TEST(OculusExamples, AZeroIsPositiveOnTheWire) {
  for (const bool second_version : {false, true}) {
    EXPECT_EQ(encode(ping_of(-0.0, second_version), m1200d), encode(ping_of(0.0, second_version), m1200d));
  }
  Status negative;
  negative.temperatures_c.fill(-0.0);
  negative.pressure_bar = -0.0;
  EXPECT_EQ(encode(negative, m1200d), encode(Status{}, m1200d));
  EXPECT_NE(encode(ping_of(-1.0, true), m1200d), encode(ping_of(1.0, true), m1200d));
}

TEST(OculusExamples, AStatusOfAnotherSizeIsNone) {
  Bytes bytes = load_fixture("status");
  bytes.push_back(0);
  EXPECT_FALSE(decode_status(bytes));
  bytes.resize(141);
  EXPECT_FALSE(decode_status(bytes));
}

TEST(OculusExamples, DummyLogAndUserConfig) {
  EXPECT_EQ(encode_dummy(m1200d), load_fixture("dummy"));
  const auto config_of = [](const char* name) {
    Json fields = message_of("oculus", name).fields;
    UserConfig config;
    take_fields<UserConfigLayout>(fields, "user_config", config);
    return config;
  };
  const UserConfig config = config_of("user_config");
  EXPECT_EQ(config.address, (std::array<std::uint8_t, 4>{192, 168, 2, 4}));
  EXPECT_EQ(encode(config, m1200d), load_fixture("user_config"));
  EXPECT_TRUE(*decode_command(load_fixture("user_config_request")) ==
              Command{config_of("user_config_request")});
  const Bytes log = encode_log("ready\n", m1200d);
  EXPECT_EQ(Bytes(log.begin() + 16, log.end()), (Bytes{'r', 'e', 'a', 'd', 'y', '\n'}));
  EXPECT_EQ(log[6], 0x80);
  EXPECT_EQ(log[10], 6);
}

}  // namespace
}  // namespace sonard::oculus::testing
