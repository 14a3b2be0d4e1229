// SPDX-License-Identifier: Apache-2.0
// Each field at its documented offset (protocol/micron/README.md 5, 6). In the examples most fields are zero
// or equal to a neighbour, so they cannot detect a swapped pair. Here every data byte holds the low 8 bits of
// its own offset, so all fields differ.
#include <gtest/gtest.h>

#include "protocol/micron/codec.hpp"
#include "tests/unit/protocol/micron/codec/fixture.hpp"

namespace sonard::micron::testing {
namespace {

/// A frame in which data byte i is i. The bytes around the data are valid.
Bytes counting_frame(bool from_head, MessageType type, std::size_t size) {
  Bytes data(size - min_frame_size);
  for (std::size_t i = 0; i < data.size(); ++i) {
    data[i] = static_cast<std::uint8_t>(frame_header_size + i);
  }
  const auto make = from_head ? frame_from_head : frame_to_head;
  return make(2, static_cast<std::uint8_t>(type), data);
}

/// The value of a little-endian integer at `offset` of a counting frame.
constexpr std::uint64_t at(std::size_t offset, std::size_t width) {
  std::uint64_t value = 0;
  for (std::size_t i = width; i-- > 0;) {
    value = value << 8 | ((offset + i) & 0xFF);
  }
  return value;
}

void expect_gain_block_at(const GainBlock& block, std::size_t offset) {
  EXPECT_EQ(block.ad_span[0], at(offset, 1));
  EXPECT_EQ(block.ad_span[1], at(offset + 1, 1));
  EXPECT_EQ(block.ad_low[0], at(offset + 2, 1));
  EXPECT_EQ(block.ad_low[1], at(offset + 3, 1));
  EXPECT_EQ(block.gain[0], at(offset + 4, 1));
  EXPECT_EQ(block.gain[1], at(offset + 5, 1));
  EXPECT_EQ(block.set_point[0], at(offset + 6, 1));
  EXPECT_EQ(block.slope[0], at(offset + 8, 2));
  EXPECT_EQ(block.slope[1], at(offset + 10, 2));
  EXPECT_EQ(block.slope_delay[0], at(offset + 12, 2));
  EXPECT_EQ(block.slope_delay[1], at(offset + 14, 2));
}

TEST(Layout, HeadCommand) {
  Bytes bytes = counting_frame(false, MessageType::head_command, 82);
  bytes[13] = 0x1D;
  const auto command = std::get<HeadCommand>(*decode_command(bytes));
  EXPECT_EQ(command.control, at(14, 2));
  EXPECT_EQ(command.head_type, at(16, 1));
  EXPECT_EQ(command.tx_word[0], at(17, 4));
  EXPECT_EQ(command.tx_word[1], at(21, 4));
  EXPECT_EQ(command.rx_word[0], at(25, 4));
  EXPECT_EQ(command.rx_word[1], at(29, 4));
  EXPECT_EQ(command.tx_pulse_us, at(33, 2));
  EXPECT_EQ(command.range_scale, at(35, 2));
  EXPECT_EQ(command.left_limit, at(37, 2));
  EXPECT_EQ(command.right_limit, at(39, 2));
  EXPECT_EQ(command.ad_span, at(41, 1));
  EXPECT_EQ(command.ad_low, at(42, 1));
  EXPECT_EQ(command.gain[0], at(43, 1));
  EXPECT_EQ(command.gain[1], at(44, 1));
  EXPECT_EQ(command.slope[0], at(45, 2));
  EXPECT_EQ(command.slope[1], at(47, 2));
  EXPECT_EQ(command.motor_time, at(49, 1));
  EXPECT_EQ(command.step, at(50, 1));
  EXPECT_EQ(command.ad_interval, at(51, 2));
  EXPECT_EQ(command.bins, at(53, 2));
  EXPECT_EQ(command.max_ad_buffer, at(55, 2));
  EXPECT_EQ(command.lockout_us, at(57, 2));
  EXPECT_EQ(command.minor_axis, at(59, 2));
  EXPECT_EQ(command.major_axis, at(61, 1));
  EXPECT_EQ(command.control_2, at(62, 1));
  EXPECT_EQ(command.scan_z, at(63, 2));
  ASSERT_TRUE(command.gain_block);
  expect_gain_block_at(*command.gain_block, 65);
  EXPECT_EQ(encode(command), bytes);
}

TEST(Layout, ShortFormOfTheHeadCommandMayHaveAnyLengthThatHoldsIt) {
  for (const std::size_t size : {66U, 70U, 82U, 120U}) {
    Bytes bytes = counting_frame(false, MessageType::head_command, size);
    bytes[13] = 0x01;
    const auto command = std::get<HeadCommand>(*decode_command(bytes));
    EXPECT_EQ(command.scan_z, at(63, 2));
    EXPECT_FALSE(command.gain_block);
    bytes[13] = 0x1D;
    EXPECT_EQ(std::get<HeadCommand>(*decode_command(bytes)).gain_block.has_value(), size >= 82) << size;
  }
}

// Fields that a head does not need may be absent. In this command these are all fields after the number of
// bins.
TEST(Layout, FieldsAtTheEndOfACommandMayBeAbsent) {
  for (const std::size_t size : {56U, 58U, 65U}) {
    Bytes bytes = counting_frame(false, MessageType::head_command, size);
    bytes[13] = 0x01;
    const auto command = std::get<HeadCommand>(*decode_command(bytes));
    EXPECT_EQ(command.bins, at(53, 2));
    EXPECT_EQ(command.scan_z, HeadCommand{}.scan_z);
  }
  Bytes bytes = counting_frame(false, MessageType::head_command, 55);
  bytes[13] = 0x01;
  EXPECT_EQ(decode_command(bytes).error(), (WireError{WireErrorReason::truncated, 53, "bins"}));

  bytes = counting_frame(false, MessageType::head_command, 21);
  bytes[13] = 0x1E;
  const GainBlock gain = std::get<GainCommand>(*decode_command(bytes)).values;
  EXPECT_EQ(gain.gain[0], at(18, 1));
  EXPECT_EQ(gain.slope[0], 0);

  EXPECT_EQ(std::get<SendData>(*decode_command(counting_frame(false, MessageType::send_data, 14))).time_ms,
            0U);
}

TEST(Layout, GainCommand) {
  Bytes bytes = counting_frame(false, MessageType::head_command, 31);
  bytes[13] = 0x1E;
  expect_gain_block_at(std::get<GainCommand>(*decode_command(bytes)).values, 14);
}

TEST(Layout, SendData) {
  const Bytes bytes = counting_frame(false, MessageType::send_data, 18);
  EXPECT_EQ(std::get<SendData>(*decode_command(bytes)).time_ms, at(13, 4));
}

TEST(Layout, VersionData) {
  const Bytes bytes = counting_frame(true, MessageType::version_data, 25);
  const auto version = std::get<VersionData>(*decode_report(bytes));
  EXPECT_EQ(version.software_version, at(13, 1));
  EXPECT_EQ(version.info, at(14, 1));
  EXPECT_EQ(version.serial_number, at(15, 2));
  EXPECT_EQ(version.program_length, at(17, 4));
  EXPECT_EQ(version.checksum, at(21, 2));
  EXPECT_EQ(version.node, at(23, 1));
  EXPECT_EQ(encode(version), bytes);
}

TEST(Layout, Alive) {
  const Bytes bytes = counting_frame(true, MessageType::alive, 22);
  const auto alive = std::get<Alive>(*decode_report(bytes));
  EXPECT_EQ(alive.needs_parameters, at(13, 1));
  EXPECT_EQ(alive.time_ms, at(14, 4));
  EXPECT_EQ(alive.position, at(18, 2));
  EXPECT_EQ(alive.head_info, at(20, 1));
  EXPECT_EQ(encode(alive), bytes);
}

TEST(Layout, HeadData) {
  Bytes bytes = counting_frame(true, MessageType::head_data, 50);
  bytes[13] = 36;
  bytes[14] = 0;
  bytes[42] = 5;
  bytes[43] = 0;
  const auto line = std::get<HeadData>(*decode_report(bytes));
  EXPECT_EQ(line.device_type, at(15, 1));
  EXPECT_EQ(line.status, at(16, 1));
  EXPECT_EQ(static_cast<std::uint8_t>(line.sweep), at(17, 1));
  EXPECT_EQ(line.control, at(18, 2));
  EXPECT_EQ(line.range_scale, at(20, 2));
  EXPECT_EQ(line.tx_word, at(22, 4));
  EXPECT_EQ(line.gain, at(26, 1));
  EXPECT_EQ(line.slope, at(27, 2));
  EXPECT_EQ(line.ad_span, at(29, 1));
  EXPECT_EQ(line.ad_low, at(30, 1));
  EXPECT_EQ(line.heading_offset, at(31, 2));
  EXPECT_EQ(line.ad_interval, at(33, 2));
  EXPECT_EQ(line.left_limit, at(35, 2));
  EXPECT_EQ(line.right_limit, at(37, 2));
  EXPECT_EQ(line.step, at(39, 1));
  EXPECT_EQ(line.bearing, at(40, 2));
  EXPECT_EQ(Bytes(line.data.begin(), line.data.end()), (Bytes{44, 45, 46, 47, 48}));
  EXPECT_EQ(encode(line), bytes);
}

TEST(Layout, BbUserData) {
  const Bytes bytes = counting_frame(true, MessageType::bb_user_data, 264);
  const auto blocks = std::get<BBUserData>(*decode_report(bytes));
  EXPECT_EQ(blocks.surface_control, at(13, 1));
  EXPECT_EQ(blocks.head_clock, at(15, 2));
  EXPECT_EQ(blocks.block_length, at(17, 2));
  EXPECT_EQ(blocks.kind, at(19, 1));
  EXPECT_EQ(blocks.lan_baud[0], at(25, 2));
  EXPECT_EQ(blocks.lan_baud[1], at(27, 2));
  EXPECT_EQ(blocks.lan_sensitivity[0], at(29, 2));
  EXPECT_EQ(blocks.lan_sensitivity[1], at(31, 2));
  EXPECT_EQ(blocks.lan_timeout, at(33, 2));
  EXPECT_EQ(blocks.main_port.baud[0], at(35, 2));
  EXPECT_EQ(blocks.main_port.baud[1], at(37, 2));
  EXPECT_EQ(blocks.main_port.parity[1], at(41, 2));
  EXPECT_EQ(blocks.main_port.data_bits[0], at(43, 2));
  EXPECT_EQ(blocks.aux_port.baud[0], at(47, 2));
  EXPECT_EQ(blocks.aux_port.data_bits[1], at(57, 2));
  EXPECT_EQ(blocks.has_motor, at(59, 1));
  EXPECT_EQ(blocks.has_aux, at(61, 1));
  EXPECT_EQ(blocks.has_roll, at(63, 1));
  EXPECT_EQ(blocks.older_half_duplex, at(99, 1));
  EXPECT_EQ(*blocks.dst_half_duplex, at(146, 1));

  const Bytes again = encode(blocks);
  ASSERT_EQ(again.size(), 264U);
  for (const std::size_t named :
       {13U, 15U, 18U, 19U, 25U, 34U, 35U, 46U, 47U, 58U, 59U, 61U, 63U, 99U, 146U}) {
    EXPECT_EQ(again[named], bytes[named]) << named;
  }
  for (const std::size_t spare : {14U, 20U, 60U, 64U, 98U, 100U, 145U, 147U, 262U}) {
    EXPECT_EQ(again[spare], 0) << spare;
  }
}

TEST(Layout, FpgaDataAndAuxData) {
  const Bytes version = counting_frame(true, MessageType::fpga_version_data, 28);
  EXPECT_EQ(encode(*decode_report(version)), version);
  const Bytes calibration = counting_frame(true, MessageType::fpga_cal_data, 80);
  EXPECT_EQ(encode(*decode_report(calibration)), calibration);
  Bytes aux = counting_frame(true, MessageType::aux_data, 20);
  aux[13] = 4;
  aux[14] = 0;
  EXPECT_EQ(std::get<AuxData>(*decode_report(aux)).data, (Bytes{15, 16, 17, 18}));
  EXPECT_EQ(encode(*decode_report(aux)), aux);
}

}  // namespace
}  // namespace sonard::micron::testing
