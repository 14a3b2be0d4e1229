// SPDX-License-Identifier: Apache-2.0
// Layout tables of all fixed-layout messages, used by the codec for reading and writing, and printable by
// tools. Source: protocol/gemini/README.md 3, 5, 6. codec.cpp handles the variable parts (SerialTransmit,
// MdioCommands, PingLine's data, SerialData, InfoBlockWrite).
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <tuple>

#include "protocol/common/layout.hpp"
#include "protocol/gemini/messages.hpp"

namespace sonard {

template <>
struct WireSize<gemini::MacAddress> : std::integral_constant<std::size_t, 6> {};

}  // namespace sonard

namespace sonard::gemini {

inline void read_value(ByteReader& reader, std::string_view name, MacAddress& mac) {
  sonard::read_value(reader, name, mac.octets);
  std::ranges::reverse(mac.octets);
}

inline void write_value(ByteWriter& writer, const MacAddress& mac) {
  auto octets = mac.octets;
  std::ranges::reverse(octets);
  writer.bytes(octets);
}

/// Layout of one message (see protocol/common/layout.hpp), offsets from the start of the datagram, header
/// included.
template <class Message>
struct Layout;

template <>
struct Layout<StatusRequest> : WholeLayout<8> {
  static constexpr auto fields = std::tuple{};
};

template <>
struct Layout<PingConfig> : WholeLayout<68> {
  static constexpr auto fields = std::tuple{
      Field{8, "idents", &PingConfig::idents},
      Field{16, "run_mode", &PingConfig::run_mode},
      Field{18, "ext_mode", &PingConfig::ext_mode},
      Field{20, "start_range", &PingConfig::start_range},
      Field{22, "end_range", &PingConfig::end_range},
      Field{24, "interping_us", &PingConfig::interping_us},
      Field{28, "tx_length", &PingConfig::tx_length},
      Field{30, "tx_angle", &PingConfig::tx_angle},
      Field{32, "main_gain", &PingConfig::main_gain},
      Field{34, "absorption", &PingConfig::absorption},
      Field{36, "software_gain", &PingConfig::software_gain},
      Field{40, "spreading", &PingConfig::spreading},
      Field{42, "auto_gain", &PingConfig::auto_gain},
      Field{44, "filter_bank", &PingConfig::filter_bank},
      Field{46, "shade_bank", &PingConfig::shade_bank},
      Field{48, "sound_speed", &PingConfig::sound_speed},
      Field{50, "velocimeter_mode", &PingConfig::velocimeter_mode},
      Field{52, "range_compression", &PingConfig::range_compression},
      Field{54, "rle_threshold", &PingConfig::rle_threshold},
      Field{56, "sample_channel", &PingConfig::sample_channel},
      Field{58, "velocimeter_gain", &PingConfig::velocimeter_gain},
      Field{60, "velocimeter_tx_length", &PingConfig::velocimeter_tx_length},
      Field{61, "tx_mark", &PingConfig::tx_mark},
      Field{62, "image_mode", &PingConfig::image_mode},
      Field{64, "power_management", &PingConfig::power_management},
      Field{65, "software_gain_ramp", &PingConfig::software_gain_ramp},
      Field{66, "velocimeter_tx_period", &PingConfig::velocimeter_tx_period},
      Field{67, "velocimeter_tx_mark", &PingConfig::velocimeter_tx_mark},
  };
};

template <>
struct Layout<FlashWrite> : WholeLayout<1040> {
  static constexpr auto fields = std::tuple{
      Field{8, "address", &FlashWrite::address},
      Field{12, "flags", &FlashWrite::flags},
      Spare<2>{14},
      Field{16, "data", &FlashWrite::data},
  };
};

template <>
struct Layout<FlashRead> : WholeLayout<12> {
  static constexpr auto fields = std::tuple{Field{8, "address", &FlashRead::address}};
};

template <>
struct Layout<InfoBlockRead> : WholeLayout<12> {
  static constexpr auto fields = std::tuple{Field{8, "bank", &InfoBlockRead::bank}};
};

template <>
struct Layout<Reboot> : WholeLayout<12> {
  static constexpr auto fields = std::tuple{Field{8, "control", &Reboot::control}, Spare<3>{9}};
};

template <>
struct Layout<TestResultRequest> : WholeLayout<12> {
  static constexpr auto fields = std::tuple{Spare<4>{8}};
};

template <>
struct Layout<ProductionTest> {
  static constexpr std::size_t size = 24;
  static constexpr std::size_t minimum = 20;  // 32-bit clients end here
  static constexpr auto fields = std::tuple{
      Field{8, "seed", &ProductionTest::seed},
      Field{16, "flags", &ProductionTest::flags},
      Spare<7>{17},
  };
};

template <>
struct Layout<PowerOnSelfTest> : WholeLayout<12> {
  static constexpr auto fields = std::tuple{Spare<4>{8}};
};

template <>
struct Layout<AbortProductionTest> : WholeLayout<12> {
  static constexpr auto fields = std::tuple{Spare<4>{8}};
};

template <>
struct Layout<RetryRequest> : WholeLayout<16> {
  static constexpr auto fields = std::tuple{
      Field{8, "kind", &RetryRequest::kind},
      Field{10, "first_line", &RetryRequest::first_line},
      Field{12, "line_count", &RetryRequest::line_count},
      Spare<2>{14},
  };
};

template <>
struct Layout<NetworkConfig> {
  static constexpr std::size_t size = 22;
  static constexpr std::size_t minimum = 20;  // early clients end here
  static constexpr auto fields = std::tuple{
      Field{8, "ethernet_ifg", &NetworkConfig::ethernet_ifg},
      Field{9, "vdsl_ifg", &NetworkConfig::vdsl_ifg},
      Field{10, "advertise_gigabit", &NetworkConfig::advertise_gigabit},
      Field{11, "rate_adaption", &NetworkConfig::rate_adaption},
      Field{12, "baud_divisor", &NetworkConfig::baud_divisor},
      Field{14, "serial_poll_us", &NetworkConfig::serial_poll_us},
      Field{16, "inter_packet_gap", &NetworkConfig::inter_packet_gap},
      Field{18, "serial_routing", &NetworkConfig::serial_routing},
      Field{20, "extension", &NetworkConfig::extension},
  };
};

template <>
struct Layout<TxDriveTest> : WholeLayout<12> {
  static constexpr auto fields = std::tuple{Field{8, "drive", &TxDriveTest::drive}, Spare<2>{10}};
};

template <>
struct Layout<GpoWrite> : WholeLayout<12> {
  static constexpr auto fields = std::tuple{Field{8, "outputs", &GpoWrite::outputs}, Spare<2>{10}};
};

template <>
struct Layout<GpioRead> : WholeLayout<12> {
  static constexpr auto fields = std::tuple{Spare<4>{8}};
};

template <>
struct Layout<DiagnosticRequest> : WholeLayout<12> {
  static constexpr auto fields = std::tuple{Spare<4>{8}};
};

template <>
struct Layout<GoingOffline> : WholeLayout<10> {
  static constexpr auto fields = std::tuple{Spare<2>{8}};
};

template <>
struct Layout<Status> : WholeLayout<110> {
  static constexpr auto fields = std::tuple{
      Field{8, "firmware_version", &Status::firmware_version},
      Field{10, "sonar_id", &Status::sonar_id},
      Field{12, "fixed_ip", &Status::fixed_ip},
      Field{16, "alternate_ip", &Status::alternate_ip},
      Field{20, "surface_ip", &Status::surface_ip},
      Field{24, "flags", &Status::flags},
      Field{26, "vcc_int", &Status::vcc_int},
      Field{28, "vcc_aux", &Status::vcc_aux},
      Field{30, "dc_voltage", &Status::dc_voltage},
      Field{32, "die_temperature", &Status::die_temperature},
      Field{34, "dip_switches", &Status::dip_switches},
      Field{36, "vga1a_temperature", &Status::vga1a_temperature},
      Field{38, "vga1b_temperature", &Status::vga1b_temperature},
      Field{40, "vga2a_temperature", &Status::vga2a_temperature},
      Field{42, "vga2b_temperature", &Status::vga2b_temperature},
      Field{44, "psu1_temperature", &Status::psu1_temperature},
      Field{46, "psu2_temperature", &Status::psu2_temperature},
      Field{48, "clock_us", &Status::clock_us},
      Field{56, "transducer", &Status::transducer},
      Field{58, "subnet_mask", &Status::subnet_mask},
      Field{62, "tx1_temperature", &Status::tx1_temperature},
      Field{64, "tx2_temperature", &Status::tx2_temperature},
      Field{66, "tx3_temperature", &Status::tx3_temperature},
      Field{68, "boot_status", &Status::boot_status},
      Field{72, "shutdown_status", &Status::shutdown_status},
      Field{74, "die_shutdown_temperature", &Status::die_shutdown_temperature},
      Field{76, "vga1a_shutdown_temperature", &Status::vga1a_shutdown_temperature},
      Field{78, "vga1b_shutdown_temperature", &Status::vga1b_shutdown_temperature},
      Field{80, "vga2a_shutdown_temperature", &Status::vga2a_shutdown_temperature},
      Field{82, "vga2b_shutdown_temperature", &Status::vga2b_shutdown_temperature},
      Field{84, "psu1_shutdown_temperature", &Status::psu1_shutdown_temperature},
      Field{86, "psu2_shutdown_temperature", &Status::psu2_shutdown_temperature},
      Field{88, "tx1_shutdown_temperature", &Status::tx1_shutdown_temperature},
      Field{90, "tx2_shutdown_temperature", &Status::tx2_shutdown_temperature},
      Field{92, "tx3_shutdown_temperature", &Status::tx3_shutdown_temperature},
      Field{94, "link_type", &Status::link_type},
      Field{96, "vdsl_downstream1", &Status::vdsl_downstream1},
      Field{98, "vdsl_downstream2", &Status::vdsl_downstream2},
      Field{100, "mac", &Status::mac},
      Field{106, "vdsl_upstream1", &Status::vdsl_upstream1},
      Field{108, "vdsl_upstream2", &Status::vdsl_upstream2},
  };
};

template <>
struct Layout<PingHead> {
  static constexpr std::size_t size = 48;
  static constexpr std::size_t minimum = 46;  // earlier heads lack the last field and the padding
  static constexpr auto fields = std::tuple{
      Field{8, "ping_id", &PingHead::ping_id},
      Field{10, "ext_mode", &PingHead::ext_mode},
      Field{12, "transmit_time_us", &PingHead::transmit_time_us},
      Field{20, "start_range", &PingHead::start_range},
      Field{22, "end_range", &PingHead::end_range},
      Field{24, "line_time", &PingHead::line_time},
      Field{28, "beams", &PingHead::beams},
      Field{30, "channels", &PingHead::channels},
      Field{32, "sample_channel", &PingHead::sample_channel},
      Field{33, "base_gain", &PingHead::base_gain},
      Field{34, "velocimeter_speed", &PingHead::velocimeter_speed},
      Field{36, "velocimeter_echo_time", &PingHead::velocimeter_echo_time},
      Field{38, "velocimeter_readings", &PingHead::velocimeter_readings},
      Field{40, "tx_angle", &PingHead::tx_angle},
      Field{42, "sound_speed_used", &PingHead::sound_speed_used},
      Field{44, "rle_threshold", &PingHead::rle_threshold},
      Field{45, "range_compression", &PingHead::range_compression},
      Field{46, "decimation", &PingHead::decimation},
      Spare<1>{47},
  };
};

/// Without the data, which follow.
template <>
struct Layout<PingLine> : WholeLayout<16> {
  static constexpr auto fields = std::tuple{
      Field{8, "gain", &PingLine::gain},
      Field{9, "ping_id", &PingLine::ping_id},
      Field{10, "line_id", &PingLine::line_id},
      Field{12, "scale", &PingLine::scale},
      Field{14, "line_info", &PingLine::line_info},
  };
};

template <>
struct Layout<PingTail> : WholeLayout<12> {
  static constexpr auto fields = std::tuple{
      Field{8, "ping_id", &PingTail::ping_id},
      Field{9, "flags", &PingTail::flags},
      Spare<2>{10},
  };
};

template <>
struct Layout<FlashResult> : WholeLayout<16> {
  static constexpr auto fields = std::tuple{
      Field{8, "address", &FlashResult::address},
      Field{12, "result", &FlashResult::result},
      Spare<2>{14},
  };
};

template <>
struct Layout<FlashReadback> : WholeLayout<1040> {
  static constexpr auto fields = std::tuple{
      Field{8, "address", &FlashReadback::address},
      Spare<4>{12},
      Field{16, "data", &FlashReadback::data},
  };
};

template <>
struct Layout<VelocimeterData> : WholeLayout<1036> {
  static constexpr auto fields = std::tuple{
      Field{8, "block_count", &VelocimeterData::block_count},
      Spare<2>{10},
      Field{12, "data", &VelocimeterData::data},
  };
};

template <>
struct Layout<Acknowledge> : WholeLayout<24> {
  static constexpr auto fields = std::tuple{
      Field{8, "receipt_us", &Acknowledge::receipt_us},
      Field{16, "reply_us", &Acknowledge::reply_us},
  };
};

template <>
struct Layout<TestResult> : WholeLayout<54> {
  static constexpr auto fields = std::tuple{
      Field{8, "marks", &TestResult::marks},
      Field{16, "sram0_result", &TestResult::sram0_result},
      Field{20, "sram1_result", &TestResult::sram1_result},
      Field{24, "flash_post_result", &TestResult::flash_post_result},
      Field{26, "flash_production_result", &TestResult::flash_production_result},
      Field{34, "first_error_address", &TestResult::first_error_address},
      Field{38, "seed_written", &TestResult::seed_written},
      Field{46, "seed_used", &TestResult::seed_used},
  };
};

template <>
struct Layout<MdioAcknowledge> : WholeLayout<10> {
  static constexpr auto fields = std::tuple{Field{8, "result", &MdioAcknowledge::result}};
};

template <>
struct Layout<GpiData> : WholeLayout<10> {
  static constexpr auto fields = std::tuple{Field{8, "inputs", &GpiData::inputs}};
};

template <>
struct Layout<Diagnostic> : WholeLayout<18> {
  static constexpr auto fields = std::tuple{
      Field{8, "rx1_board", &Diagnostic::rx1_board},    Field{10, "rx2_board", &Diagnostic::rx2_board},
      Field{12, "fpga_board", &Diagnostic::fpga_board}, Field{14, "psu_board", &Diagnostic::psu_board},
      Field{16, "tx_board", &Diagnostic::tx_board},
  };
};

/// Messages with a layout table. The table may lack their last, variable part.
template <class Message>
concept HasLayout = requires {
  Layout<Message>::size;
};

}  // namespace sonard::gemini
