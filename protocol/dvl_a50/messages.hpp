// SPDX-License-Identifier: Apache-2.0
// What a DVL A50 reports, as values. Section numbers refer to protocol/dvl_a50/README.md.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace sonard::dvl_a50 {

/// In the vehicle frame of the device: x forward, y right, z down.
using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;  ///< [row][column]

/// One of the four beams.
struct Beam {
  int id = 0;                 ///< 0..3
  double velocity_mps = 0.0;  ///< along the beam, positive towards where it points
  double distance_m = -1.0;   ///< along the beam; -1: no echo
  double rssi_dbm = 0.0;
  double nsd_dbm = 0.0;
  bool valid = false;

  bool operator==(const Beam&) const = default;
};

/// The report of one ping.
struct Velocity {
  bool of_water = false;       ///< water tracking: relative to the water, without an altitude
  double since_last_ms = 0.0;  ///< since the report before
  Vector velocity_mps{};
  double fom_mps = 0.0;
  Matrix covariance{};  ///< (m/s)^2
  double altitude_m = -1.0;
  std::array<Beam, 4> beams{};
  bool valid = false;
  int status = 0;  ///< bit 0: hot
  // Microseconds since 1970.
  std::int64_t validity_us = 0;      ///< when the bottom reflected the ping
  std::int64_t transmission_us = 0;  ///< when the report was sent

  bool operator==(const Velocity&) const = default;
};

/// The dead-reckoning report: relative to the vehicle frame at the last reset.
struct Position {
  double time_s = 0.0;  ///< since 1970
  Vector position_m{};
  double std_m = 0.0;  ///< horizontal
  double roll_deg = 0.0, pitch_deg = 0.0, yaw_deg = 0.0;
  int status = 0;  ///< 0: fine

  bool operator==(const Position&) const = default;
};

/// What set_config sets.
struct Settings {
  double speed_of_sound_mps = 1475.0;         ///< 1000..2000
  bool acoustic_enabled = true;               ///< false: only triggered pings
  bool dark_mode_enabled = false;             ///< of the LED
  double mounting_rotation_offset_deg = 0.0;  ///< 0..360, clockwise from the vehicle's forward axis
  std::string range_mode = "auto";            ///< "auto", "=a", "a<=b", "wt"
  bool periodic_cycling_enabled = true;

  bool operator==(const Settings&) const = default;
};

}  // namespace sonard::dvl_a50
