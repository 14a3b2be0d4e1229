// SPDX-License-Identifier: Apache-2.0
// Each field at its documented offset. In the examples most fields are zero or equal to a neighbour, so they
// cannot detect a swapped pair. Here every byte of the datagram holds its own offset, so all fields differ.
#include <gtest/gtest.h>

#include <numeric>

#include "protocol/gemini/codec.hpp"
#include "tests/unit/protocol/gemini/codec/fixture.hpp"

namespace sonard::gemini::testing {
namespace {

/// Byte i of the datagram is i, except byte 0, which holds the type.
Bytes counting_datagram(MessageType type, std::size_t size) {
  Bytes bytes(size);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  bytes[0] = static_cast<std::uint8_t>(type);
  return bytes;
}

/// The value of a little-endian integer at `offset` of a counting datagram.
constexpr std::uint64_t at(std::size_t offset, std::size_t width) {
  std::uint64_t value = 0;
  for (std::size_t i = width; i-- > 0;) {
    value = value << 8 | (offset + i);
  }
  return value;
}
static_assert(at(8, 2) == 0x0908);
static_assert(at(24, 4) == 0x1B1A1918);

template <class Message, class Variant>
Message message_in(Result<Variant, WireError> decoded) {
  return std::get<Message>(decoded.value());
}

TEST(Layout, Header) {
  const Bytes bytes = counting_datagram(MessageType::status_request, 8);
  const auto header = decode_header(bytes);
  ASSERT_TRUE(header);
  EXPECT_EQ(header->version, 1);
  EXPECT_EQ(header->sonar_id, at(2, 2));
  EXPECT_EQ(header->packet_latency, at(4, 2));
  EXPECT_EQ(header->destination, 6);
  EXPECT_EQ(header->source, 7);
  EXPECT_EQ(encode(*decode_command(bytes)), bytes);
}

// Section 5.
TEST(Layout, PingConfig) {
  const Bytes bytes = counting_datagram(MessageType::ping_config, 68);
  const auto config = message_in<PingConfig>(decode_command(bytes));
  EXPECT_EQ(config.idents[0], at(8, 2));
  EXPECT_EQ(config.idents[1], at(10, 2));
  EXPECT_EQ(config.idents[2], at(12, 2));
  EXPECT_EQ(config.idents[3], at(14, 2));
  EXPECT_EQ(config.run_mode, at(16, 2));
  EXPECT_EQ(config.ext_mode, at(18, 2));
  EXPECT_EQ(config.start_range, at(20, 2));
  EXPECT_EQ(config.end_range, at(22, 2));
  EXPECT_EQ(config.interping_us, at(24, 4));
  EXPECT_EQ(config.tx_length, at(28, 2));
  EXPECT_EQ(config.tx_angle, at(30, 2));
  EXPECT_EQ(config.main_gain, at(32, 2));
  EXPECT_EQ(config.absorption, at(34, 2));
  EXPECT_EQ(config.software_gain, at(36, 4));
  EXPECT_EQ(config.spreading, at(40, 2));
  EXPECT_EQ(config.auto_gain, at(42, 2));
  EXPECT_EQ(config.filter_bank, at(44, 2));
  EXPECT_EQ(config.shade_bank, at(46, 2));
  EXPECT_EQ(config.sound_speed, at(48, 2));
  EXPECT_EQ(config.velocimeter_mode, at(50, 2));
  EXPECT_EQ(config.range_compression, at(52, 2));
  EXPECT_EQ(config.rle_threshold, at(54, 2));
  EXPECT_EQ(config.sample_channel, at(56, 2));
  EXPECT_EQ(config.velocimeter_gain, at(58, 2));
  EXPECT_EQ(config.velocimeter_tx_length, 60);
  EXPECT_EQ(config.tx_mark, 61);
  EXPECT_EQ(config.image_mode, at(62, 2));
  EXPECT_EQ(config.power_management, 64);
  EXPECT_EQ(config.software_gain_ramp, 65);
  EXPECT_EQ(config.velocimeter_tx_period, 66);
  EXPECT_EQ(config.velocimeter_tx_mark, 67);
  EXPECT_EQ(encode(config), bytes);
}

// Section 3.3.
TEST(Layout, Status) {
  const Bytes bytes = counting_datagram(MessageType::status, 110);
  const auto status = message_in<Status>(decode_report(bytes));
  EXPECT_EQ(status.firmware_version, at(8, 2));
  EXPECT_EQ(status.sonar_id, at(10, 2));
  EXPECT_EQ(status.fixed_ip, at(12, 4));
  EXPECT_EQ(status.alternate_ip, at(16, 4));
  EXPECT_EQ(status.surface_ip, at(20, 4));
  EXPECT_EQ(status.flags, at(24, 2));
  EXPECT_EQ(status.vcc_int, at(26, 2));
  EXPECT_EQ(status.vcc_aux, at(28, 2));
  EXPECT_EQ(status.dc_voltage, at(30, 2));
  EXPECT_EQ(status.die_temperature, at(32, 2));
  EXPECT_EQ(status.dip_switches, at(34, 2));
  EXPECT_EQ(status.vga1a_temperature, at(36, 2));
  EXPECT_EQ(status.vga1b_temperature, at(38, 2));
  EXPECT_EQ(status.vga2a_temperature, at(40, 2));
  EXPECT_EQ(status.vga2b_temperature, at(42, 2));
  EXPECT_EQ(status.psu1_temperature, at(44, 2));
  EXPECT_EQ(status.psu2_temperature, at(46, 2));
  EXPECT_EQ(status.clock_us, at(52, 4) << 32 | at(48, 4)) << "low word at 48, high word at 52";
  EXPECT_EQ(status.transducer, at(56, 2));
  EXPECT_EQ(status.subnet_mask, at(58, 4));
  EXPECT_EQ(status.tx1_temperature, at(62, 2));
  EXPECT_EQ(status.tx2_temperature, at(64, 2));
  EXPECT_EQ(status.tx3_temperature, at(66, 2));
  EXPECT_EQ(status.boot_status, at(68, 4));
  EXPECT_EQ(status.shutdown_status, at(72, 2));
  EXPECT_EQ(status.die_shutdown_temperature, at(74, 2));
  EXPECT_EQ(status.vga1a_shutdown_temperature, at(76, 2));
  EXPECT_EQ(status.vga1b_shutdown_temperature, at(78, 2));
  EXPECT_EQ(status.vga2a_shutdown_temperature, at(80, 2));
  EXPECT_EQ(status.vga2b_shutdown_temperature, at(82, 2));
  EXPECT_EQ(status.psu1_shutdown_temperature, at(84, 2));
  EXPECT_EQ(status.psu2_shutdown_temperature, at(86, 2));
  EXPECT_EQ(status.tx1_shutdown_temperature, at(88, 2));
  EXPECT_EQ(status.tx2_shutdown_temperature, at(90, 2));
  EXPECT_EQ(status.tx3_shutdown_temperature, at(92, 2));
  EXPECT_EQ(status.link_type, at(94, 2));
  EXPECT_EQ(status.vdsl_downstream1, at(96, 2));
  EXPECT_EQ(status.vdsl_downstream2, at(98, 2));
  EXPECT_EQ(status.mac, (MacAddress{{105, 104, 103, 102, 101, 100}})) << "least significant pair first";
  EXPECT_EQ(status.vdsl_upstream1, at(106, 2));
  EXPECT_EQ(status.vdsl_upstream2, at(108, 2));
  EXPECT_EQ(encode(status), bytes);
}

// Section 6.2.
TEST(Layout, PingHead) {
  Bytes bytes = counting_datagram(MessageType::ping_head, 48);
  const auto head = message_in<PingHead>(decode_report(bytes));
  EXPECT_EQ(head.ping_id, at(8, 2));
  EXPECT_EQ(head.ext_mode, at(10, 2));
  EXPECT_EQ(head.transmit_time_us, at(16, 4) << 32 | at(12, 4)) << "low word at 12, high word at 16";
  EXPECT_EQ(head.start_range, at(20, 2));
  EXPECT_EQ(head.end_range, at(22, 2));
  EXPECT_EQ(head.line_time, at(24, 4));
  EXPECT_EQ(head.beams, at(28, 2));
  EXPECT_EQ(head.channels, at(30, 2));
  EXPECT_EQ(head.sample_channel, 32);
  EXPECT_EQ(head.base_gain, 33);
  EXPECT_EQ(head.velocimeter_speed, at(34, 2));
  EXPECT_EQ(head.velocimeter_echo_time, at(36, 2));
  EXPECT_EQ(head.velocimeter_readings, at(38, 2));
  EXPECT_EQ(head.tx_angle, at(40, 2));
  EXPECT_EQ(head.sound_speed_used, at(42, 2));
  EXPECT_EQ(head.rle_threshold, 44);
  EXPECT_EQ(head.range_compression, 45);
  EXPECT_EQ(head.decimation, 46);
  bytes[47] = 0;  // padding is sent as zero
  EXPECT_EQ(encode(head), bytes);
}

// Sections 6.4 and 6.9.
TEST(Layout, PingLineAndTail) {
  Bytes line_bytes = counting_datagram(MessageType::ping_line, 16);
  const std::size_t words = at(14, 2) >> 7;
  line_bytes.resize(16 + 4 * words, 0xCD);
  const auto line = message_in<PingLine>(decode_report(line_bytes));
  EXPECT_EQ(line.gain, 8);
  EXPECT_EQ(line.ping_id, 9);
  EXPECT_EQ(line.line_id, at(10, 2));
  EXPECT_EQ(line.scale, at(12, 2));
  EXPECT_EQ(line.line_info, at(14, 2));
  EXPECT_EQ(line.data.size(), 4 * words);
  EXPECT_EQ(encode(line), line_bytes);

  const auto tail = message_in<PingTail>(decode_report(counting_datagram(MessageType::ping_tail, 12)));
  EXPECT_EQ(tail.ping_id, 8);
  EXPECT_EQ(tail.flags, 9);
}

// Section 3.6.
TEST(Layout, NetworkConfig) {
  const Bytes bytes = counting_datagram(MessageType::network_config, 22);
  const auto config = message_in<NetworkConfig>(decode_command(bytes));
  EXPECT_EQ(config.ethernet_ifg, 8);
  EXPECT_EQ(config.vdsl_ifg, 9);
  EXPECT_EQ(config.advertise_gigabit, 10);
  EXPECT_EQ(config.rate_adaption, 11);
  EXPECT_EQ(config.baud_divisor, at(12, 2));
  EXPECT_EQ(config.serial_poll_us, at(14, 2));
  EXPECT_EQ(config.inter_packet_gap, at(16, 2));
  EXPECT_EQ(config.serial_routing, at(18, 2));
  EXPECT_EQ(config.extension, at(20, 2));
  EXPECT_EQ(encode(config), bytes);
}

// Section 3.5.
TEST(Layout, RetryRequest) {
  const auto retry =
      message_in<RetryRequest>(decode_command(counting_datagram(MessageType::retry_request, 16)));
  EXPECT_EQ(static_cast<std::uint16_t>(retry.kind), at(8, 2)) << "an unknown kind is kept as it came";
  EXPECT_EQ(retry.first_line, at(10, 2));
  EXPECT_EQ(retry.line_count, at(12, 2));
}

// Section 3.10.
TEST(Layout, TestResult) {
  const Bytes bytes = counting_datagram(MessageType::test_result, 54);
  const auto result = message_in<TestResult>(decode_report(bytes));
  EXPECT_EQ(result.marks[0], at(8, 2));
  EXPECT_EQ(result.marks[3], at(14, 2));
  EXPECT_EQ(result.sram0_result, at(16, 4));
  EXPECT_EQ(result.sram1_result, at(20, 4));
  EXPECT_EQ(result.flash_post_result, at(24, 2));
  EXPECT_EQ(result.flash_production_result, at(30, 4) << 32 | at(26, 4));
  EXPECT_EQ(result.first_error_address, at(34, 4));
  EXPECT_EQ(result.seed_written, at(38, 8));
  EXPECT_EQ(result.seed_used, at(46, 8));
  EXPECT_EQ(encode(result), bytes);
}

TEST(Layout, AcknowledgeAndDiagnostic) {
  const auto acknowledge =
      message_in<Acknowledge>(decode_report(counting_datagram(MessageType::acknowledge, 24)));
  EXPECT_EQ(acknowledge.receipt_us, at(12, 4) << 32 | at(8, 4));
  EXPECT_EQ(acknowledge.reply_us, at(20, 4) << 32 | at(16, 4));

  const auto diagnostic =
      message_in<Diagnostic>(decode_report(counting_datagram(MessageType::diagnostic, 18)));
  EXPECT_EQ(diagnostic.rx1_board, at(8, 2));
  EXPECT_EQ(diagnostic.rx2_board, at(10, 2));
  EXPECT_EQ(diagnostic.fpga_board, at(12, 2));
  EXPECT_EQ(diagnostic.psu_board, at(14, 2));
  EXPECT_EQ(diagnostic.tx_board, at(16, 2));
}

}  // namespace
}  // namespace sonard::gemini::testing
