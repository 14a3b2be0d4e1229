// SPDX-License-Identifier: Apache-2.0
// The byte examples in both directions (docs/protocols/oculus.md 10; tests/data/oculus/notes.md).
#include <gtest/gtest.h>

#include "tests/unit/protocol/oculus/codec/fixture.hpp"

namespace sonard::oculus::testing {
namespace {

struct FireExample {
  std::string fixture;
  SimpleFire value;
  bool states_its_size = true;
};

void PrintTo(const FireExample& example, std::ostream* out) {
  *out << example.fixture;
}

constexpr double ensta_range_m = 2.54;

std::vector<FireExample> fire_examples() {
  const Fire ensta{2, 0, 255, 127, 0x0D, ensta_range_m, 50.0, 0.0, 0.0};
  return {
      {"fire_vendor", {0, {1, 0, 255, 127, 0x49, 10.0, 20.0, 0.0, 35.0}, {}}, false},
      {"fire_ensta", {0, ensta, {}}},
      {"fire_ensta_standby", {0, {2, 5, 255, 127, 0x0D, 5.0, 80.0, 1500.0, 0.0}, {}}},
      {"fire_ensta_resume_v2", {2, ensta, {}}},
      {"fire_liboculus_8_bit", {2, {2, 0, 255, 127, 0x4D, 4.0, 50.0, 0.0, 0.0}, FireExtension{}}},
      {"fire_liboculus_32_bit", {2, {2, 0, 255, 127, 0x4F, 4.0, 50.0, 0.0, 0.0}, FireExtension{0x200, {}}}},
  };
}

class OculusFireExample : public ::testing::TestWithParam<FireExample> {};

TEST_P(OculusFireExample, BytesMeanTheValue) {
  const auto command = decode_command(load_fixture(GetParam().fixture));
  ASSERT_TRUE(command) << to_string(command.error());
  EXPECT_TRUE(*command == Command{GetParam().value});
}

TEST_P(OculusFireExample, ValueBecomesTheBytes) {
  if (GetParam().states_its_size) {
    EXPECT_EQ(encode(GetParam().value), load_fixture(GetParam().fixture));
  }
}

std::string example_name(const ::testing::TestParamInfo<FireExample>& example) {
  return example.param.fixture;
}
INSTANTIATE_TEST_SUITE_P(all, OculusFireExample, ::testing::ValuesIn(fire_examples()), example_name);

PingResult first_ping() {
  PingResult ping;
  ping.fire = {1, {1, 0, 255, 127, 0x0D, 10.0, 50.0, 0.0, 35.0}, {}};
  ping.ping_id = 42;
  ping.frequency_hz = 750e3;
  ping.temperature_c = 18.5;
  ping.pressure_bar = 1.25;
  ping.sound_speed_mps = 1500.0;
  ping.start_time_ns = 123'456'789;
  ping.range_resolution_m = 1500.0 / (2.0 * 37.5e6 / 143.0);
  ping.ranges = 3;
  ping.image_offset = 136;
  ping.bearings_cdeg = {-6500, -1757, 1757, 6500};
  return ping;
}

const Bytes first_image{1, 0, 0, 0, 0, 1, 2, 3, 4, 0, 0, 0, 10, 11, 12, 13, 16, 0, 0, 0, 20, 21, 22, 23};

PingResult second_ping() {
  PingResult ping = first_ping();
  ping.fire = {2, {2, 0, 255, 127, 0x0B, 5.0, 70.0, 1500.0, 0.0}, FireExtension{}};
  ping.ping_id = 43;
  ping.frequency_hz = 2.1e6;
  ping.heading_deg = 90.0;
  ping.pitch_deg = -1.5;
  ping.roll_deg = 2.5;
  ping.start_time_s = 12.345678;
  ping.data_size = DataSize::bits_16;
  ping.image_offset = 216;
  ping.bearings_cdeg = {-3000, -959, 959, 3000};
  return ping;
}

const Bytes second_image{0,    0, 1,    0, 2,    0, 3,    0, 0xE8, 3, 0xE9, 3,
                         0xEA, 3, 0xEB, 3, 0xD0, 7, 0xD1, 7, 0xD2, 7, 0xD3, 7};

TEST(OculusExamples, PingOfVersion1BecomesTheBytes) {
  PingResult ping = first_ping();
  ping.image = first_image;
  EXPECT_EQ(encode(ping, m1200d), load_fixture("ping_result_v1"));
}

TEST(OculusExamples, PingOfVersion2BecomesTheBytes) {
  PingResult ping = second_ping();
  ping.image = second_image;
  EXPECT_EQ(encode(ping, m1200d), load_fixture("ping_result_v2"));
}

TEST(OculusExamples, BytesAreThePings) {
  for (const auto& [fixture, wanted, image] : {std::tuple{"ping_result_v1", first_ping(), first_image},
                                               std::tuple{"ping_result_v2", second_ping(), second_image}}) {
    const Bytes bytes = load_fixture(fixture);
    const auto ping = decode_ping_result(bytes);
    ASSERT_TRUE(ping) << to_string(ping.error());
    EXPECT_TRUE(ping->fire == wanted.fire) << fixture;
    EXPECT_EQ(ping->ping_id, wanted.ping_id);
    EXPECT_EQ(ping->heading_deg, wanted.fire.extension ? 90.0 : 0.0);
    EXPECT_EQ(ping->data_size, wanted.data_size);
    EXPECT_EQ(ping->bearings_cdeg, wanted.bearings_cdeg);
    EXPECT_EQ(Bytes(ping->image.begin(), ping->image.end()), image);
    EXPECT_EQ(encode(*ping, m1200d), bytes);
  }
}

TEST(OculusExamples, StatusBothWays) {
  Status status;
  status.device_id = 7892;
  status.part_number = 1042;
  status.firmware = {0x01030007, 0x0134B35D, 0x01030007, 0x0134B35D, 0x00020001, 0x0134B35D};
  status.address = {192, 168, 2, 4};
  status.netmask = {255, 255, 255, 0};
  status.mac = {0x00, 0x1E, 0x63, 1, 2, 3};
  status.temperatures_c = {30.0, 30.5, 31.0, 31.5, 32.0, 32.5, 18.5, 33.0};
  status.pressure_bar = 1.25;
  EXPECT_EQ(encode(status, m1200d), load_fixture("status"));
  EXPECT_TRUE(decode_status(load_fixture("status")).value() == status);
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
  const UserConfig config{{192, 168, 2, 4}, {255, 255, 255, 0}, 0};
  EXPECT_EQ(encode(config, m1200d), load_fixture("user_config"));
  EXPECT_TRUE(*decode_command(load_fixture("user_config_request")) == Command{UserConfig{}});
  const Bytes log = encode_log("ready\n", m1200d);
  EXPECT_EQ(Bytes(log.begin() + 16, log.end()), (Bytes{'r', 'e', 'a', 'd', 'y', '\n'}));
  EXPECT_EQ(log[6], 0x80);
  EXPECT_EQ(log[10], 6);
}

}  // namespace
}  // namespace sonard::oculus::testing
