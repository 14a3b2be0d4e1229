// SPDX-License-Identifier: Apache-2.0
// Layout tables of all messages, used by the codec for reading and writing. Offsets are from the start of the
// frame; sizes exclude the line feed at its end. Source: protocol/micron/README.md 5, 6. codec.cpp handles
// the parts that depend on the message itself (forms of the head command, data of lines, older user blocks).
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>

#include "protocol/common/layout.hpp"
#include "protocol/micron/frame.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {

/// Table of one message or of its fixed part (protocol/common/layout.hpp). A command may lack fields at its
/// end that a head does not need. Its table requires bytes up to the last needed field; missing fields keep
/// the defaults of the struct (2.5).
template <class Message>
struct Layout;

template <>
struct Layout<SendData> {
  static constexpr std::size_t size = 17;
  static constexpr std::size_t minimum = 13;
  static constexpr auto fields = std::tuple{Field{13, "time_ms", &SendData::time_ms}};
};

/// Follows the byte of the form. A head uses no fields after `bins`.
template <>
struct Layout<HeadCommand> {
  static constexpr std::size_t size = 65;
  static constexpr std::size_t minimum = 55;
  static constexpr auto fields = std::tuple{
      Field{14, "control", &HeadCommand::control},
      Field{16, "head_type", &HeadCommand::head_type},
      Field{17, "tx_word", &HeadCommand::tx_word},
      Field{25, "rx_word", &HeadCommand::rx_word},
      Field{33, "tx_pulse_us", &HeadCommand::tx_pulse_us},
      Field{35, "range_scale", &HeadCommand::range_scale},
      Field{37, "left_limit", &HeadCommand::left_limit},
      Field{39, "right_limit", &HeadCommand::right_limit},
      Field{41, "ad_span", &HeadCommand::ad_span},
      Field{42, "ad_low", &HeadCommand::ad_low},
      Field{43, "gain", &HeadCommand::gain},
      Field{45, "slope", &HeadCommand::slope},
      Field{49, "motor_time", &HeadCommand::motor_time},
      Field{50, "step", &HeadCommand::step},
      Field{51, "ad_interval", &HeadCommand::ad_interval},
      Field{53, "bins", &HeadCommand::bins},
      Field{55, "max_ad_buffer", &HeadCommand::max_ad_buffer},
      Field{57, "lockout_us", &HeadCommand::lockout_us},
      Field{59, "minor_axis", &HeadCommand::minor_axis},
      Field{61, "major_axis", &HeadCommand::major_axis},
      Field{62, "control_2", &HeadCommand::control_2},
      Field{63, "scan_z", &HeadCommand::scan_z},
  };
};

/// Offsets are from the block's start: byte 14 of a gain command, byte 65 of a long head command. A head uses
/// no fields after `gain`.
template <>
struct Layout<GainBlock> {
  static constexpr std::size_t size = 16;
  static constexpr std::size_t minimum = 6;
  static constexpr auto fields = std::tuple{
      Field{0, "ad_span", &GainBlock::ad_span}, Field{2, "ad_low", &GainBlock::ad_low},
      Field{4, "gain", &GainBlock::gain},       Field{6, "set_point", &GainBlock::set_point},
      Field{8, "slope", &GainBlock::slope},     Field{12, "slope_delay", &GainBlock::slope_delay},
  };
};

template <>
struct Layout<VersionData> : WholeLayout<24> {
  static constexpr auto fields = std::tuple{
      Field{13, "software_version", &VersionData::software_version},
      Field{14, "info", &VersionData::info},
      Field{15, "serial_number", &VersionData::serial_number},
      Field{17, "program_length", &VersionData::program_length},
      Field{21, "checksum", &VersionData::checksum},
      Field{23, "node", &VersionData::node},
  };
};

template <>
struct Layout<Alive> : WholeLayout<21> {
  static constexpr auto fields = std::tuple{
      Field{13, "needs_parameters", &Alive::needs_parameters},
      Field{14, "time_ms", &Alive::time_ms},
      Field{18, "position", &Alive::position},
      Field{20, "head_info", &Alive::head_info},
  };
};

/// The fields between the total count and the data count.
template <>
struct Layout<HeadData> : WholeLayout<42> {
  static constexpr auto fields = std::tuple{
      Field{15, "device_type", &HeadData::device_type},
      Field{16, "status", &HeadData::status},
      Field{17, "sweep", &HeadData::sweep},
      Field{18, "control", &HeadData::control},
      Field{20, "range_scale", &HeadData::range_scale},
      Field{22, "tx_word", &HeadData::tx_word},
      Field{26, "gain", &HeadData::gain},
      Field{27, "slope", &HeadData::slope},
      Field{29, "ad_span", &HeadData::ad_span},
      Field{30, "ad_low", &HeadData::ad_low},
      Field{31, "heading_offset", &HeadData::heading_offset},
      Field{33, "ad_interval", &HeadData::ad_interval},
      Field{35, "left_limit", &HeadData::left_limit},
      Field{37, "right_limit", &HeadData::right_limit},
      Field{39, "step", &HeadData::step},
      Field{40, "bearing", &HeadData::bearing},
  };
};

/// Offsets are from the start of the settings: bytes 35 and 47 of the user blocks.
template <>
struct Layout<PortSettings> : WholeLayout<12> {
  static constexpr auto fields = std::tuple{
      Field{0, "baud", &PortSettings::baud},
      Field{4, "parity", &PortSettings::parity},
      Field{8, "data_bits", &PortSettings::data_bits},
  };
};

inline void read_value(ByteReader& reader, std::string_view, PortSettings& port) {
  read_fields<Layout<PortSettings>>(reader, port);
}
inline void write_value(ByteWriter& writer, const PortSettings& port) {
  write_fields<Layout<PortSettings>>(writer, port);
}

}  // namespace sonard::micron

template <>
struct sonard::WireSize<sonard::micron::PortSettings> : std::integral_constant<std::size_t, 12> {};

namespace sonard::micron {

/// The common fields of older heads and a DST.
template <>
struct Layout<BBUserData> : WholeLayout<100> {
  static constexpr auto fields = std::tuple{
      Field{13, "surface_control", &BBUserData::surface_control},
      Spare<1>{14},
      Field{15, "head_clock", &BBUserData::head_clock},
      Field{17, "block_length", &BBUserData::block_length},
      Field{19, "kind", &BBUserData::kind},
      Spare<5>{20},
      Field{25, "lan_baud", &BBUserData::lan_baud},
      Field{29, "lan_sensitivity", &BBUserData::lan_sensitivity},
      Field{33, "lan_timeout", &BBUserData::lan_timeout},
      Field{35, "main_port", &BBUserData::main_port},
      Field{47, "aux_port", &BBUserData::aux_port},
      Field{59, "has_motor", &BBUserData::has_motor},
      Spare<1>{60},
      Field{61, "has_aux", &BBUserData::has_aux},
      Spare<1>{62},
      Field{63, "has_roll", &BBUserData::has_roll},
      Spare<35>{64},
      Field{99, "older_half_duplex", &BBUserData::older_half_duplex},
  };
};

template <>
struct Layout<FpgaVersionData> : WholeLayout<27> {
  static constexpr auto fields = std::tuple{Field{13, "data", &FpgaVersionData::data}};
};

template <>
struct Layout<FpgaCalData> : WholeLayout<79> {
  static constexpr auto fields = std::tuple{Field{13, "data", &FpgaCalData::data}};
};

}  // namespace sonard::micron
