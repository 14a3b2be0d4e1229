// SPDX-License-Identifier: Apache-2.0
// The messages of a Micron as values, both directions, one struct per message.
// Source: protocol/micron/README.md, section numbers beside each struct. Members keep the device's own
// integers and units (units.hpp), so that decode and encode lose nothing. Spare fields are written as zero
// and skipped on reading. "Client" is the computer of the vehicle; "head" is the sonar. Multi-byte integers
// are little-endian. Frame headers (frame.hpp) are not part of a message.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace sonard::micron {

inline constexpr int max_bins = 1500;                ///< per line, the maximum that any driver requests (4)
inline constexpr std::uint8_t device_type_dst = 17;  ///< of every Micron (6.3)
inline constexpr std::uint8_t dst_user_blocks = 15;  ///< BBUserData::kind of every Micron (6.4)

enum class MessageType : std::uint8_t {
  version_data = 1,
  head_data = 2,
  alive = 4,
  bb_user_data = 6,
  aux_data = 8,
  reboot = 16,
  head_command = 19,
  send_version = 23,
  send_bb_user = 24,
  send_data = 25,
  send_fpga_version = 56,
  fpga_version_data = 57,
  send_fpga_cal_data = 62,
  fpga_cal_data = 63,
  stop_alives = 66,
};

/// A message of an unknown type. Receivers must ignore it (3).
struct Unknown {
  std::uint8_t type = 0;

  bool operator==(const Unknown&) const = default;
};

// ---- Client -> head

/// Answered by VersionData (5.1).
struct SendVersion {
  static constexpr MessageType type = MessageType::send_version;
  bool operator==(const SendVersion&) const = default;
};

/// Answered by BBUserData, FpgaCalData, FpgaVersionData (5.1, 6.4).
struct SendBBUser {
  static constexpr MessageType type = MessageType::send_bb_user;
  bool operator==(const SendBBUser&) const = default;
};

/// Not answered (7.4).
struct Reboot {
  static constexpr MessageType type = MessageType::reboot;
  bool operator==(const Reboot&) const = default;
};

/// Stops Alive messages until the next reboot (5.1).
struct StopAlives {
  static constexpr MessageType type = MessageType::stop_alives;
  bool operator==(const StopAlives&) const = default;
};

struct SendFpgaVersion {
  static constexpr MessageType type = MessageType::send_fpga_version;
  bool operator==(const SendFpgaVersion&) const = default;
};

struct SendFpgaCalData {
  static constexpr MessageType type = MessageType::send_fpga_cal_data;
  bool operator==(const SendFpgaCalData&) const = default;
};

/// Requests one line, or in full duplex two (5.2, 8.1).
struct SendData {
  static constexpr MessageType type = MessageType::send_data;
  std::uint32_t time_ms = 0;  ///< time of day; 0: not set

  bool operator==(const SendData&) const = default;
};

/// Bits of HeadCommand::control and HeadData::control (5.4).
namespace control_bits {
inline constexpr std::uint16_t eight_bit = 0x0001;   ///< clear: two bins per byte
inline constexpr std::uint16_t continuous = 0x0002;  ///< clear: sector between the limits
inline constexpr std::uint16_t scan_right = 0x0004;  ///< clockwise; clear: counter-clockwise
inline constexpr std::uint16_t invert = 0x0008;      ///< mounted boot down
inline constexpr std::uint16_t motor_off = 0x0010;
inline constexpr std::uint16_t transmit_off = 0x0020;
inline constexpr std::uint16_t channel_2 = 0x0080;
inline constexpr std::uint16_t raw = 0x0100;             ///< always set
inline constexpr std::uint16_t has_motor = 0x0200;       ///< always set
inline constexpr std::uint16_t stare = 0x1000;           ///< hold still at the left limit
inline constexpr std::uint16_t reply_analogue = 0x2000;  ///< always set
}  // namespace control_bits

/// Gain and window of both channels: the body of GainCommand, and the last block of some HeadCommands. A
/// Micron has only channel 1 (5.5).
struct GainBlock {
  std::array<std::uint8_t, 2> ad_span{};
  std::array<std::uint8_t, 2> ad_low{};
  std::array<std::uint8_t, 2> gain{};
  std::array<std::uint8_t, 2> set_point{};
  std::array<std::uint16_t, 2> slope{};
  std::array<std::uint16_t, 2> slope_delay{};

  bool operator==(const GainBlock&) const = default;
};

/// All parameters of a scan (5.3). Defaults: as in the ROS driver, a continuous scan to the right with 400
/// bins over 10 m.
struct HeadCommand {
  static constexpr MessageType type = MessageType::head_command;
  std::uint16_t control = control_bits::eight_bit | control_bits::continuous | control_bits::scan_right |
                          control_bits::raw | control_bits::has_motor | control_bits::reply_analogue;
  std::uint8_t head_type = device_type_dst;  ///< varies between drivers; ignored
  std::array<std::uint32_t, 2> tx_word{};    ///< transmit frequency; a Micron ignores it
  std::array<std::uint32_t, 2> rx_word{};    ///< ignored
  std::uint16_t tx_pulse_us = 0;             ///< ignored
  std::uint16_t range_scale = 100;  ///< bits 13..0 range in 0.1; 15..14 unit: m, ft, fathom, yd. Only copied
  std::uint16_t left_limit = 2400;
  std::uint16_t right_limit = 3999;
  std::uint8_t ad_span = 255;
  std::uint8_t ad_low = 0;
  std::array<std::uint8_t, 2> gain{105, 105};  ///< initial gain, 0..210; the second is ignored
  std::array<std::uint16_t, 2> slope{};        ///< ignored
  std::uint8_t motor_time = 25;                ///< time to turn by one unit of bearing, in 10 us
  std::uint8_t step = 32;                      ///< units of bearing between lines; 0 acts as 16
  std::uint16_t ad_interval = 53;              ///< time between bins, in 640 ns
  std::uint16_t bins = 400;
  std::uint16_t max_ad_buffer = 500;  ///< ignored
  std::uint16_t lockout_us = 100;     ///< ignored: a common driver sends ten times too much
  std::uint16_t minor_axis = 1600;    ///< ignored
  std::uint8_t major_axis = 1;        ///< ignored
  std::uint8_t control_2 = 0;         ///< ignored
  std::uint16_t scan_z = 0;           ///< ignored
  std::optional<GainBlock>
      gain_block;  ///< in the longer form only; ignored, because drivers leave arbitrary values in it

  bool has(std::uint16_t control_bit) const { return (control & control_bit) != 0; }

  bool operator==(const HeadCommand&) const = default;
};

/// A form of the head command that changes only gain and window (5.5).
struct GainCommand {
  static constexpr MessageType type = MessageType::head_command;
  GainBlock values;

  bool operator==(const GainCommand&) const = default;
};

/// A form of the head command that reverses the scan (5.6).
struct ReverseCommand {
  static constexpr MessageType type = MessageType::head_command;
  bool operator==(const ReverseCommand&) const = default;
};

using Command = std::variant<Unknown, SendVersion, SendBBUser, Reboot, StopAlives, SendFpgaVersion,
                             SendFpgaCalData, SendData, HeadCommand, GainCommand, ReverseCommand>;

// ---- Head -> client

/// 25 bytes (6.1). The defaults are from a published example.
struct VersionData {
  static constexpr MessageType type = MessageType::version_data;
  std::uint8_t software_version = 0x31;
  std::uint8_t info = 0x11;
  std::uint16_t serial_number = 0x8C0D;
  std::uint32_t program_length = 43'139;
  std::uint16_t checksum = 0x883C;
  std::uint8_t node = 2;

  bool operator==(const VersionData&) const = default;
};

/// Bits of Alive::head_info (6.2).
namespace head_info_bits {
inline constexpr std::uint8_t centring = 0x01;
inline constexpr std::uint8_t centred = 0x02;
inline constexpr std::uint8_t motoring = 0x04;  ///< turning to the centre, or to a new sector
inline constexpr std::uint8_t motor_on = 0x08;
inline constexpr std::uint8_t off_centre = 0x10;
inline constexpr std::uint8_t scanning = 0x20;
inline constexpr std::uint8_t no_parameters = 0x40;
inline constexpr std::uint8_t sent_config = 0x80;  ///< user blocks were requested or parameters came (7.3)
}  // namespace head_info_bits

/// 22 bytes, once a second (6.2).
struct Alive {
  static constexpr MessageType type = MessageType::alive;
  std::uint8_t needs_parameters = 0x80;  ///< 0x80 or 0
  std::uint32_t time_ms = 0;
  std::uint16_t position = 3200;  ///< bearing of the transducer
  std::uint8_t head_info = 0;

  bool has(std::uint8_t info_bit) const { return (head_info & info_bit) != 0; }

  bool operator==(const Alive&) const = default;
};

/// Bits of HeadData::status (6.3).
namespace head_status_bits {
inline constexpr std::uint8_t power_loss = 0x01;
inline constexpr std::uint8_t motor_error = 0x02;  ///< the motor lost its position; a HeadCommand is needed
inline constexpr std::uint8_t eight_bit = 0x10;
inline constexpr std::uint8_t aux_follows = 0x80;
}  // namespace head_status_bits

enum class SweepCode : std::uint8_t { normal = 0, left_limit = 1, right_limit = 2, centre = 5 };

/// One line: 45 bytes plus the data (6.3).
struct HeadData {
  static constexpr MessageType type = MessageType::head_data;
  std::uint8_t device_type = device_type_dst;
  std::uint8_t status = 0;
  SweepCode sweep = SweepCode::normal;
  std::uint16_t control = 0;
  std::uint16_t range_scale = 0;
  std::uint32_t tx_word = 0;
  std::uint8_t gain = 0;
  std::uint16_t slope = 0;
  std::uint8_t ad_span = 0;
  std::uint8_t ad_low = 0;
  std::uint16_t heading_offset = 0;
  std::uint16_t ad_interval = 0;
  std::uint16_t left_limit = 0;
  std::uint16_t right_limit = 0;
  std::uint8_t step = 0;
  std::uint16_t bearing = 0;
  std::span<const std::uint8_t> data;  ///< bins from near to far, packed as in bins.hpp; not owned

  bool eight_bit() const { return (control & control_bits::eight_bit) != 0; }

  bool operator==(const HeadData& other) const;
};

/// Three settings, each for the low and the high speed of a port: 0 or a code (6.4).
struct PortSettings {
  std::array<std::uint16_t, 2> baud{};  ///< 1 = 2400, 2 = 4800, ... 5 = 38400, 6 = 57600, 7 = 115200
  std::array<std::uint16_t, 2> parity{};
  std::array<std::uint16_t, 2> data_bits{};  ///< 0 = 8

  bool operator==(const PortSettings&) const = default;
};

/// User blocks: 264 bytes from a Micron, 175 from older heads (6.4).
struct BBUserData {
  static constexpr MessageType type = MessageType::bb_user_data;
  std::uint8_t surface_control = 0xFF;
  std::uint16_t head_clock = 0x1234;
  std::uint16_t block_length = 250;
  std::uint8_t kind = dst_user_blocks;
  std::array<std::uint16_t, 2> lan_baud{};
  std::array<std::uint16_t, 2> lan_sensitivity{};
  std::uint16_t lan_timeout = 3;
  PortSettings main_port{.baud = {7, 7}};
  PortSettings aux_port;
  std::uint8_t has_motor = 1;
  std::uint8_t has_aux = 0;
  std::uint8_t has_roll = 0;
  std::uint8_t older_half_duplex = 0;  ///< the duplex mode of heads other than DST
  /// The duplex mode of a DST; nullopt: the short message of an older head.
  std::optional<std::uint8_t> dst_half_duplex = std::uint8_t{0};

  bool half_duplex() const { return dst_half_duplex.value_or(older_half_duplex) != 0; }

  bool operator==(const BBUserData&) const = default;
};

/// 28 bytes of unknown meaning (6.5).
struct FpgaVersionData {
  static constexpr MessageType type = MessageType::fpga_version_data;
  std::array<std::uint8_t, 14> data{};

  bool operator==(const FpgaVersionData&) const = default;
};

/// 80 bytes of unknown meaning (6.5).
struct FpgaCalData {
  static constexpr MessageType type = MessageType::fpga_cal_data;
  std::array<std::uint8_t, 66> data{};

  bool operator==(const FpgaCalData&) const = default;
};

/// Data from a device on the auxiliary port (6.6).
struct AuxData {
  static constexpr MessageType type = MessageType::aux_data;
  std::vector<std::uint8_t> data;

  bool operator==(const AuxData&) const = default;
};

using Report =
    std::variant<Unknown, VersionData, Alive, HeadData, BBUserData, FpgaVersionData, FpgaCalData, AuxData>;

}  // namespace sonard::micron
