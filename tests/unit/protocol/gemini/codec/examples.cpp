// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/protocol/gemini/codec/examples.hpp"

#include <numeric>

namespace sonard::gemini::testing {
namespace {

constexpr Header from_601{.sonar_id = 601};
constexpr Header later_client_to_601{.sonar_id = 601, .destination = 2, .source = 1};
constexpr Header later_client_to_1234{.sonar_id = 1234, .destination = 2, .source = 1};

/// Counts up modulo 256, like the data of the fixtures.
template <std::size_t N>
std::array<std::uint8_t, N> counting() {
  std::array<std::uint8_t, N> bytes;
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

/// Section 10: single ping, 8 bit, out-of-water override, 483 lines (4 m), 200 ms, 1499.2 m/s from the
/// config.
PingConfig ping_config() {
  PingConfig config;
  config.header = from_601;
  config.idents = {0, 0, 0, 0};
  config.run_mode = 0;
  config.ext_mode = 0x0204;
  config.start_range = 0;
  config.end_range = 483;
  config.interping_us = 200'000;
  config.tx_length = 4;
  config.tx_angle = 0;
  config.main_gain = 0x83E8;
  config.absorption = 0;
  config.software_gain = 0x1E00;
  config.spreading = 67;
  config.auto_gain = 0;
  config.filter_bank = 7;
  config.shade_bank = 1;
  config.sound_speed = 14'992;
  config.velocimeter_mode = 1;
  config.range_compression = 0;
  config.rle_threshold = 0;
  config.sample_channel = 0;
  config.velocimeter_gain = 0;
  config.velocimeter_tx_length = 1;
  config.tx_mark = 29;
  config.image_mode = 0;
  config.power_management = 1;
  config.software_gain_ramp = 18;
  config.velocimeter_tx_period = 30;
  config.velocimeter_tx_mark = 17;
  return config;
}

/// Section 10: "header sub-device bytes, velMode 0, 482 lines, 250 ms, 1500.0 m/s".
PingConfig ping_config_later_client() {
  PingConfig config = ping_config();
  config.header = later_client_to_601;
  config.end_range = 482;
  config.interping_us = 250'000;
  config.spreading = 213;
  config.sound_speed = 15'000;
  config.velocimeter_mode = 0;
  return config;
}

/// 10 m, gain 50 %, 1500 m/s, single ping.
PingConfig observed_ping_config() {
  PingConfig config = ping_config();
  config.header = later_client_to_1234;
  config.ext_mode = 0x0004;
  config.end_range = 1206;
  config.main_gain = 0xC3E8;
  config.spreading = 213;
  config.filter_bank = 6;
  config.sound_speed = 15'000;
  return config;
}

PingConfig observed_ping_config_mk2() {
  PingConfig config = observed_ping_config();
  config.header.destination = 0x1E;
  config.tx_length = 9;
  config.main_gain = 0;
  config.software_gain = 0xFF;
  config.spreading = 0;
  config.filter_bank = 0x8006;
  config.range_compression = 0x0100;
  config.software_gain_ramp = 0;
  return config;
}

/// Defaults of section 3.6, and the values 0x0100 and 10000 that later clients send.
NetworkConfig network_config(const Header& header) {
  NetworkConfig config;
  config.header = header;
  config.ethernet_ifg = 15;
  config.vdsl_ifg = 15;
  config.advertise_gigabit = 0;
  config.rate_adaption = 0;
  config.baud_divisor = 1302;
  config.serial_poll_us = 50'000;
  config.inter_packet_gap = 0;
  config.serial_routing = 0x0100;
  config.extension = 10'000;
  return config;
}

NetworkConfig network_config_early() {
  NetworkConfig config = network_config(from_601);
  config.ethernet_ifg = 12;
  config.vdsl_ifg = 16;
  config.inter_packet_gap = 8000;
  config.serial_routing = 0;
  config.extension = std::nullopt;
  return config;
}

/// The status that section 10 describes above its bytes.
Status status() {
  Status status;
  status.header = from_601;
  status.firmware_version = 0x0119;
  status.sonar_id = 601;
  status.fixed_ip = 10U << 24 | 61U << 16 | 19U << 8 | 200U;
  status.alternate_ip = 192U << 24 | 168U << 16 | 2U << 8 | 201U;
  status.surface_ip = 192U << 24 | 168U << 16 | 2U << 8 | 5U;
  status.flags = 0;
  status.vcc_int = 341;
  status.vcc_aux = 853;
  status.dc_voltage = 2400;
  status.die_temperature = die_temperature_code(45.0);
  status.vga1a_temperature = temperature_code(21.25);
  status.vga1b_temperature = temperature_code(21.5);
  status.vga2a_temperature = temperature_code(22.0);
  status.vga2b_temperature = temperature_code(21.75);
  status.psu1_temperature = 0;
  status.psu2_temperature = temperature_code(30.0);
  status.clock_us = 0x12345678;
  status.transducer = 1;
  status.subnet_mask = 0xFFFFFF00;
  status.tx1_temperature = temperature_code(24.0);
  status.tx2_temperature = temperature_code(24.25);
  status.tx3_temperature = temperature_code(24.5);
  status.boot_status = 0x105;
  status.shutdown_status = 0;
  status.die_shutdown_temperature = die_temperature_code(85.0);
  status.vga1a_shutdown_temperature = temperature_code(60.0);
  status.vga1b_shutdown_temperature = temperature_code(60.0);
  status.vga2a_shutdown_temperature = temperature_code(60.0);
  status.vga2b_shutdown_temperature = temperature_code(60.0);
  status.psu1_shutdown_temperature = 0;
  status.psu2_shutdown_temperature = temperature_code(70.0);
  status.tx1_shutdown_temperature = temperature_code(60.0);
  status.tx2_shutdown_temperature = temperature_code(60.0);
  status.tx3_shutdown_temperature = temperature_code(60.0);
  status.link_type = 4;
  status.mac = {{0x00, 0x12, 0x34, 0x00, 0x02, 0x59}};
  return status;
}

/// Section 10: ping 5, extMode 0x0204, t = 0x12350000 us, lines 0..483, base gain 2, 1499.2 m/s from the
/// config.
PingHead ping_head() {
  PingHead head;
  head.header = from_601;
  head.ping_id = 5;
  head.ext_mode = 0x0204;
  head.transmit_time_us = 0x12350000;
  head.start_range = 0;
  head.end_range = 483;
  head.beams = 256;
  head.channels = 96;
  head.base_gain = 2;
  head.velocimeter_speed = 14'992;
  head.velocimeter_readings = 1;
  head.sound_speed_used = 0x8000 | 14'992;
  return head;
}

PingLine ping_line() {
  static const auto samples = counting<256>();
  PingLine line;
  line.header = from_601;
  line.gain = 0;
  line.ping_id = 5;
  line.line_id = 0;
  line.scale = 0x1E00;
  line.line_info = 0x2004;
  line.data = samples;
  return line;
}

}  // namespace

std::vector<CommandExample> command_examples() {
  return {
      {"status_request", StatusRequest{from_601}},
      {"observed_status_request", StatusRequest{later_client_to_1234}},
      {"ping_config", ping_config()},
      {"ping_config_later_client", ping_config_later_client()},
      {"observed_ping_config", observed_ping_config()},
      {"observed_ping_config_mk2", observed_ping_config_mk2()},
      {"flash_write", FlashWrite{from_601, 0x120400, 1, counting<1024>()}},
      {"flash_read", FlashRead{from_601, 0x01020304}},
      {"info_block_write_identity", InfoBlockWrite{from_601, 0, IdentityBlock{602, 1}}},
      {"info_block_write_velocimeter", InfoBlockWrite{from_601, 0, VelocimeterBlock{123456789, -2}}},
      // 192.168.2.77, mask 255.255.255.0
      {"observed_info_block_write",
       InfoBlockWrite{later_client_to_1234, 0, AddressBlock{0xC0A8024D, 0xFFFFFF00}}},
      {"info_block_read", InfoBlockRead{from_601, 2}},
      {"serial_transmit", SerialTransmit{from_601, {0x40, 0x30, 0x0A}}},
      {"observed_reboot", Reboot{later_client_to_1234, 1}},
      {"test_result_request", TestResultRequest{from_601}},
      {"production_test", ProductionTest{from_601, 0x8102030405060708, 1}},
      {"power_on_self_test", PowerOnSelfTest{from_601}},
      {"abort_production_test", AbortProductionTest{from_601}},
      {"retry_line", RetryRequest{from_601, RetryKind::lines, 10, 1}},
      {"retry_tail", RetryRequest{from_601, RetryKind::tail, 0, 1}},
      {"observed_retry_lines", RetryRequest{later_client_to_1234, RetryKind::lines, 40, 3}},
      {"observed_retry_tail", RetryRequest{later_client_to_1234, RetryKind::tail, 0, 1}},
      {"network_config", network_config(later_client_to_601)},
      {"observed_network_config", network_config(later_client_to_1234)},
      {"network_config_early", network_config_early()},
      // select the VDSL modem, write 0x5B11 to register 0x10
      {"mdio_commands", MdioCommands{from_601, {0x0056, 0x0053, 0x0010, 0x5B11}}},
      {"tx_drive_test", TxDriveTest{from_601, 0x1234}},
      {"gpo_write", GpoWrite{from_601, 1}},
      {"gpio_read", GpioRead{from_601}},
      {"observed_diagnostic_request", DiagnosticRequest{later_client_to_1234}},
      {"observed_going_offline", GoingOffline{later_client_to_1234}},
  };
}

std::vector<ReportExample> report_examples() {
  TestResult test_result;
  test_result.header = from_601;
  test_result.marks = {0xA000, 0xA001, 0xA002, 0xA003};
  test_result.sram0_result = 0x10000000;
  test_result.sram1_result = 0x10000000;
  test_result.flash_post_result = 0x1000;
  test_result.flash_production_result = 0;
  test_result.first_error_address = 0xFFFFFFFF;
  return {
      {"status", status()},
      {"ping_head", ping_head()},
      {"ping_line", ping_line()},
      {"ping_tail", PingTail{from_601, 5, 0}},
      {"ping_tail_resent", PingTail{from_601, 5, 0x80}},
      {"flash_result", FlashResult{from_601, 0x120400, 0x8000}},
      {"flash_readback", FlashReadback{from_601, 0x7E0000, counting<1024>()}},
      {"velocimeter_data", VelocimeterData{from_601, 2, counting<1024>()}},
      {"serial_data", SerialData{from_601, {{0x01020304050607, 0x41}, {0x01020304050608, 0x42}}}},
      {"acknowledge", Acknowledge{from_601, 0x12345678, 0x123456A0}},
      {"test_result", test_result},
      {"mdio_acknowledge", MdioAcknowledge{from_601, 0}},
      {"gpi_data", GpiData{from_601, 5}},
      {"diagnostic", Diagnostic{from_601, 1, 2, 3, 4, 5}},
  };
}

}  // namespace sonard::gemini::testing
