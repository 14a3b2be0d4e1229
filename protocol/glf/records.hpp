// SPDX-License-Identifier: Apache-2.0
// The two records of a .glf or .dat log that this library writes: images and statuses, as values.
// Source: protocol/glf/README.md 1.3 to 1.5. Members hold the values of the file in its units, so that decode
// and encode lose nothing. The packing of pixels is not part of a value.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace sonard::glf {

/// Types of records. Logs of other programs contain more types, at which third-party readers lose track.
enum class RecordType : std::uint8_t { image = 0, status = 3 };

/// Time and source of a record, from its header.
struct Origin {
  double time_s = 0.0;          ///< since 1980-01-01 00:00:00 local time (log_time.hpp)
  std::uint16_t device_id = 0;  ///< sonar ID, with which readers distinguish the sonars of a log
  std::uint16_t node_id = 100;  ///< 100 + number of the Gemini, 100..109

  bool operator==(const Origin&) const = default;
};

enum class SonarType : std::uint8_t { mk1_imager = 0, mk1_profiler = 1, mk2_imager = 2 };

/// Platforms, with the names that readers use; logs may contain other values.
enum class Platform : std::uint8_t { gemini_720i = 0, gemini_720is = 1, gemini_720ik = 2, gemini_1200ik = 4 };

/// Bits of ImageRecord::ping_flags.
namespace ping_flag_bits {
inline constexpr std::uint16_t high_frequency = 0x0100;
inline constexpr std::uint16_t manual_sound_speed = 0x8000;  ///< clear: from the sonar's own velocimeter
}  // namespace ping_flag_bits

/// One ping.
struct ImageRecord {
  Origin origin;
  std::uint32_t first_line = 0;
  std::uint32_t lines = 0;
  /// The number of its own lines that the head averaged: 2^n, n in the low four bits; with 0x20 set, n
  /// itself. Readers divide lines and frequency by it, so that it cancels. Never 0x20 alone: readers would
  /// divide by zero.
  std::uint16_t range_compression = 0;
  std::uint32_t first_beam = 0;
  std::uint32_t beams = 0;
  /// lines * beams bytes, 0..255, line after line: index = line * beams + beam, line 0 nearest. Beams are in
  /// the order of the wire, beam 0 to port.
  std::vector<std::uint8_t> pixels;
  /// One for each beam, monotonic, as in the file (bearing_for_log()).
  std::vector<double> bearings_rad;
  std::uint32_t state_flags = 0;
  /// Rate of range lines, > 0, not the acoustic frequency: a line has sound_speed_mps / 2 / this metres.
  std::uint32_t modulation_frequency_hz = 0;
  float aperture_deg = 120.0F;
  double transmit_time_s = 0.0;  ///< equal to Origin::time_s, because readers differ in which they use
  std::uint16_t ping_flags = 0;
  float sound_speed_mps = 0.0F;   ///< at the transducer
  std::int16_t gain_percent = 0;  ///< 0..100
  bool chirp = false;
  SonarType sonar_type = SonarType::mk1_imager;
  Platform platform = Platform::gemini_720i;

  bool operator==(const ImageRecord&) const = default;
};

/// Converts a bearing of the wire to a bearing in a log's table. Tables in logs descend from about +60
/// degrees (port), on the wire bearings ascend from -60 degrees (port). Pixels keep the wire's order of beams
/// (protocol/glf/README.md 1.4). It is its own inverse.
constexpr double bearing_for_log(double wire_bearing_rad) {
  return -wire_bearing_rad;
}

/// Health of a sonar, about once per second. Temperatures in degrees Celsius.
struct StatusRecord {
  Origin origin;
  std::uint16_t version = 1;  ///< of the status message
  std::uint16_t bf_firmware_version = 0;
  std::uint16_t da_version = 0;
  std::uint16_t flags = 0;
  std::uint16_t device_id = 0;              ///< equal to Origin::device_id
  std::uint8_t selected_transducer = 0xFF;  ///< 0 or 1; 0xFF: not selected
  double fpga_board_c = 0.0;
  double hsc_board_c = 0.0;
  double da_fpga_c = 0.0;
  double transducer_c = 0.0;
  double psu_c = 0.0;
  double die_c = 0.0;
  double tx_c = 0.0;
  std::array<double, 8> afe_c{};  ///< top and bottom of AFE 0, of AFE 1, ...
  std::uint16_t link_type = 0;    ///< bits: protocol/glf/README.md 1.5
  double uplink_mbps = 0.0;
  double downlink_mbps = 0.0;
  std::uint16_t link_quality_percent = 0;
  std::uint32_t packet_count = 0;
  std::uint32_t receive_error_count = 0;
  std::uint32_t resent_count = 0;
  std::uint32_t dropped_count = 0;
  std::uint32_t unknown_count = 0;
  std::uint32_t lost_line_count = 0;
  std::uint32_t general_count = 0;
  std::uint32_t alternate_ip = 0;
  std::uint32_t surface_ip = 0;
  std::uint32_t subnet_mask = 0x00FFFFFF;
  std::array<std::uint16_t, 3> mac{};
  std::uint32_t bf_boot_status = 0;
  std::uint32_t da_boot_status = 0;
  std::uint64_t fpga_time_us = 0;
  std::uint16_t dip_switch = 0;
  std::uint16_t shutdown_status = 0;  ///< bits: 0 over-temperature, 1 out-of-water shutdown, 2 out of water
  bool network_adaptor_found = false;

  bool operator==(const StatusRecord&) const = default;
};

}  // namespace sonard::glf
