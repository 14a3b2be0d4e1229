// SPDX-License-Identifier: Apache-2.0
// The messages of an Oculus as plain values. Source: protocol/oculus/README.md (section numbers in brackets).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace sonard::oculus {

inline constexpr std::uint16_t oculus_id = 0x4F53;
inline constexpr std::size_t header_size = 16;
inline constexpr std::size_t fire_v1_size = 53;  ///< with the header
inline constexpr std::size_t fire_v2_size = 89;
inline constexpr std::size_t result_v1_size = 122;  ///< up to the bearings
inline constexpr std::size_t result_v2_size = 202;
inline constexpr std::size_t status_size = 142;
inline constexpr std::size_t user_config_size = 28;

enum class MessageId : std::uint16_t {
  status = 0,  ///< in the datagram; clients do not read it (2)
  simple_fire = 0x15,
  simple_ping_result = 0x23,
  user_config = 0x55,
  logs = 0x80,
  dummy = 0xFF,
};

/// The header of every message (1).
struct Header {
  std::uint16_t magic = oculus_id;
  std::uint16_t source = 0;  ///< ID of the head; 0 from a client
  std::uint16_t destination = 0;
  MessageId id = MessageId::dummy;
  std::uint16_t version = 0;
  std::uint32_t payload_size = 0;  ///< bytes after the header; 0 from some clients (3.1)
  std::uint16_t part_number = 0;

  bool operator==(const Header&) const = default;
};

namespace fire_flags {
inline constexpr std::uint8_t range_in_metres = 0x01;  ///< clear: in percent of the maximum range
inline constexpr std::uint8_t sixteen_bit = 0x02;
inline constexpr std::uint8_t row_gains = 0x04;  ///< a gain of four bytes before every row of the image
inline constexpr std::uint8_t simple_result = 0x08;
inline constexpr std::uint8_t gain_assistance = 0x10;
inline constexpr std::uint8_t beams_512 = 0x40;  ///< clear: 256 beams
}  // namespace fire_flags

namespace extension_flags {
inline constexpr std::uint32_t thirty_two_bit = 0x200;
}  // namespace extension_flags

/// The common part of both versions of the command (3).
struct Fire {
  std::uint8_t master_mode = 2;       ///< 1: low frequency, 2: high frequency
  std::uint8_t ping_rate = 0;         ///< a code (3.3)
  std::uint8_t network_speed = 0xFF;  ///< Mbit/s; 0 and 255: no limit
  std::uint8_t gamma = 127;           ///< 255 and 0: linear, 127: square root
  std::uint8_t flags = fire_flags::range_in_metres | fire_flags::row_gains | fire_flags::simple_result;
  double range = 2.0;  ///< metres or percent
  double gain_percent = 50.0;
  double sound_speed_mps = 0.0;  ///< 0: computed from salinity and temperature
  double salinity_ppt = 0.0;

  bool operator==(const Fire&) const = default;
};

/// The additional part of version 2.
struct FireExtension {
  std::uint32_t flags = 0;
  std::array<std::uint32_t, 8> reserved{};

  bool operator==(const FireExtension&) const = default;
};

struct SimpleFire {
  std::uint16_t version = 0;  ///< as stated in the header; the extension decides the real version (3.1)
  Fire fire;
  std::optional<FireExtension> extension;

  bool operator==(const SimpleFire&) const = default;
};

/// Address and mask are in the order of the message, first octet first (5).
struct UserConfig {
  std::array<std::uint8_t, 4> address{};  ///< all zero from a client: requests the current values
  std::array<std::uint8_t, 4> netmask{};
  std::uint32_t dhcp = 0;

  bool operator==(const UserConfig&) const = default;
};

/// A message to which no known client needs an answer.
struct Unknown {
  MessageId id = MessageId::dummy;

  bool operator==(const Unknown&) const = default;
};

using Command = std::variant<SimpleFire, UserConfig, Unknown>;

/// Width of a sample (4.1).
enum class DataSize : std::uint8_t { bits_8 = 0, bits_16 = 1, bits_24 = 2, bits_32 = 3 };

/// A ping with its image; version 2 if the fire has an extension (4). Members marked with a version keep
/// their defaults in the other.
struct PingResult {
  SimpleFire fire;  ///< as acknowledged by the head (4.4)
  std::uint32_t ping_id = 0;
  std::uint32_t status = 0;
  double frequency_hz = 0.0;
  double temperature_c = 0.0;
  double pressure_bar = 0.0;
  double heading_deg = 0.0;  ///< version 2
  double pitch_deg = 0.0;    ///< version 2
  double roll_deg = 0.0;     ///< version 2
  double sound_speed_mps = 0.0;
  std::uint32_t start_time_ns = 0;  ///< version 1, modulo 2^32
  double start_time_s = 0.0;        ///< version 2, since power-up
  DataSize data_size = DataSize::bits_8;
  double range_resolution_m = 0.0;  ///< row r covers [r, r + 1) times this
  std::uint16_t ranges = 0;         ///< rows of the image
  std::uint16_t beams = 0;
  std::uint32_t image_offset = 0;  ///< from the start of the message
  std::uint32_t image_size = 0;    ///< bytes
  std::uint32_t message_size = 0;  ///< bytes, with the header

  std::vector<std::int16_t>
      bearings_cdeg;                    ///< hundredths of a degree, positive to starboard, `beams` of them
  std::span<const std::uint8_t> image;  ///< `image_size` bytes, not owned (4.7)
};

/// The datagram that a head broadcasts (6).
struct Status {
  std::uint32_t device_id = 0;
  std::uint16_t device_type = 1;  ///< imaging sonar
  std::uint16_t part_number = 0;
  std::uint32_t status = 3;                 ///< 3: no error
  std::array<std::uint32_t, 6> firmware{};  ///< versions and dates of two processors and the FPGA
  std::array<std::uint8_t, 4> address{};    ///< first octet first
  std::array<std::uint8_t, 4> netmask{};
  std::array<std::uint8_t, 4> client{};  ///< all zero: no client is connected
  std::array<std::uint8_t, 6> mac{};
  std::array<double, 8> temperatures_c{};
  double pressure_bar = 0.0;

  bool operator==(const Status&) const = default;
};

}  // namespace sonard::oculus
