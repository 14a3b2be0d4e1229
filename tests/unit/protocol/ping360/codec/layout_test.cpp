// SPDX-License-Identifier: Apache-2.0
// Each field at its documented offset (protocol/ping360/README.md 2). In the examples some fields are zero or
// equal to a neighbour, so they cannot detect a swapped pair. Here every byte of a payload holds its own
// offset, so all fields differ. Offsets count from the start of the payload, as in the document.
#include <gtest/gtest.h>

#include <numeric>

#include "protocol/ping360/codec.hpp"
#include "tests/unit/protocol/ping360/codec/fixture.hpp"

namespace sonard::ping360::testing {
namespace {

/// A frame in which byte i of the payload is i + 1.
Bytes counting_frame(MessageId id, std::size_t size) {
  Bytes payload(size);
  std::iota(payload.begin(), payload.end(), std::uint8_t{1});
  return make_frame(static_cast<std::uint16_t>(id), 0, 0, payload);
}

constexpr std::uint8_t u8(std::size_t offset) {
  return static_cast<std::uint8_t>(offset + 1);
}
constexpr std::uint16_t u16(std::size_t offset) {
  return static_cast<std::uint16_t>(u8(offset) | u8(offset + 1) << 8);
}

TEST(Ping360Layout, Transducer) {
  const auto command = std::get<Transducer>(*decode_command(counting_frame(MessageId::transducer, 14)));
  EXPECT_EQ(command.mode, u8(0));
  EXPECT_EQ(command.gain_setting, u8(1));
  EXPECT_EQ(command.angle, u16(2));
  EXPECT_EQ(command.transmit_duration_us, u16(4));
  EXPECT_EQ(command.sample_period, u16(6));
  EXPECT_EQ(command.transmit_frequency_khz, u16(8));
  EXPECT_EQ(command.number_of_samples, u16(10));
  EXPECT_EQ(command.transmit, u8(12));
}

TEST(Ping360Layout, AutoTransmit) {
  const auto command = std::get<AutoTransmit>(*decode_command(counting_frame(MessageId::auto_transmit, 16)));
  EXPECT_EQ(command.mode, u8(0));
  EXPECT_EQ(command.gain_setting, u8(1));
  EXPECT_EQ(command.transmit_duration_us, u16(2));
  EXPECT_EQ(command.sample_period, u16(4));
  EXPECT_EQ(command.transmit_frequency_khz, u16(6));
  EXPECT_EQ(command.number_of_samples, u16(8));
  EXPECT_EQ(command.start_angle, u16(10));
  EXPECT_EQ(command.stop_angle, u16(12));
  EXPECT_EQ(command.num_steps, u8(14));
  EXPECT_EQ(command.delay_ms, u8(15));
  EXPECT_EQ(encode(command), counting_frame(MessageId::auto_transmit, 16));
}

TEST(Ping360Layout, SmallCommands) {
  EXPECT_TRUE(*decode_command(counting_frame(MessageId::set_common_device_id, 1)) ==
              Command{SetCommonDeviceId{1}});
  EXPECT_TRUE(*decode_command(counting_frame(MessageId::set_device_id, 2)) == Command{SetDeviceId{1}});
  EXPECT_TRUE(*decode_command(counting_frame(MessageId::reset, 2)) == Command{Reset{1}});
  EXPECT_TRUE(*decode_command(counting_frame(MessageId::general_request, 2)) ==
              Command{GeneralRequest{0x0201}});
}

TEST(Ping360Layout, DeviceData) {
  Bytes payload(14 + 3);
  std::iota(payload.begin(), payload.end(), std::uint8_t{1});
  payload[12] = 3;
  payload[13] = 0;
  const Bytes frame = make_frame(2300, 2, 0, payload);
  const auto data = std::get<DeviceData>(*decode_report(frame));
  EXPECT_EQ(data.mode, u8(0));
  EXPECT_EQ(data.gain_setting, u8(1));
  EXPECT_EQ(data.angle, u16(2));
  EXPECT_EQ(data.transmit_duration_us, u16(4));
  EXPECT_EQ(data.sample_period, u16(6));
  EXPECT_EQ(data.transmit_frequency_khz, u16(8));
  EXPECT_EQ(data.number_of_samples, u16(10));
  EXPECT_EQ(Bytes(data.data.begin(), data.data.end()), (Bytes{15, 16, 17}));
  EXPECT_EQ(encode(data), frame);
}

TEST(Ping360Layout, AutoDeviceData) {
  Bytes payload(20 + 2);
  std::iota(payload.begin(), payload.end(), std::uint8_t{1});
  payload[18] = 2;
  payload[19] = 0;
  const Bytes frame = make_frame(2301, 2, 0, payload);
  const auto data = std::get<AutoDeviceData>(*decode_report(frame));
  EXPECT_EQ(data.mode, u8(0));
  EXPECT_EQ(data.gain_setting, u8(1));
  EXPECT_EQ(data.angle, u16(2));
  EXPECT_EQ(data.transmit_duration_us, u16(4));
  EXPECT_EQ(data.sample_period, u16(6));
  EXPECT_EQ(data.transmit_frequency_khz, u16(8));
  EXPECT_EQ(data.start_angle, u16(10));
  EXPECT_EQ(data.stop_angle, u16(12));
  EXPECT_EQ(data.num_steps, u8(14));
  EXPECT_EQ(data.delay_ms, u8(15));
  EXPECT_EQ(data.number_of_samples, u16(16));
  EXPECT_EQ(Bytes(data.data.begin(), data.data.end()), (Bytes{21, 22}));
  EXPECT_EQ(encode(data), frame);
}

TEST(Ping360Layout, SmallReports) {
  EXPECT_TRUE(*decode_report(counting_frame(MessageId::device_information, 6)) ==
              (Report{DeviceInformation{1, 2, 3, 4, 5}}));
  EXPECT_TRUE(*decode_report(counting_frame(MessageId::protocol_version, 4)) ==
              (Report{ProtocolVersion{1, 2, 3}}));
  EXPECT_TRUE(*decode_report(counting_frame(MessageId::ack, 2)) == Report{Ack{0x0201}});
  EXPECT_TRUE(*decode_report(counting_frame(MessageId::nack, 4)) == (Report{Nack{0x0201, "\3\4"}}));
}

}  // namespace
}  // namespace sonard::ping360::testing
