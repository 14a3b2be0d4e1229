// SPDX-License-Identifier: Apache-2.0
// What a user wants of a scan, and what a Micron makes of it.
#pragma once

#include <optional>

#include "protocol/micron/messages.hpp"

namespace sonard::micron {

/// Clockwise from `left` to `right`, in units of the wire (protocol/micron/units.hpp), 0..6399, not equal.
struct ScanSector {
  int left = 0;
  int right = 0;
};

struct ScanSettings {
  double range_m = 10.0;                            ///< > 0
  int bins = 400;                                   ///< 1..1500
  int step = 32;                                    ///< 1/16 gradian, 1..255
  std::optional<ScanSector> sector = std::nullopt;  ///< nullopt: all round
  bool clockwise = true;                            ///< of a sector: at first
  double gain_percent = 50.0;                       ///< 0..100
  bool eight_bit = true;                            ///< false: two bins to a byte, of the window below
  double ad_low_db = 0.0;                           ///< 0..80
  double ad_span_db = 80.0;                         ///< 0..80
  double sound_speed_mps = 1500.0;                  ///< in which ranges are counted; the head knows none
};

/// 640 ns between bins: most drivers cut the fraction off (docs/protocols/micron.md 4), so the head covers
/// at most the range that was asked for. May be beyond 1..65535.
int ad_interval(const ScanSettings& settings);

/// Requires 1 <= ad_interval(settings) <= 65535.
HeadCommand make_head_command(const ScanSettings& settings);

/// What the head then does: the length of a bin, and of all of them.
double bin_length_m(const ScanSettings& settings);
double covered_range_m(const ScanSettings& settings);

/// Degrees, 0 ahead, positive to starboard, -180 <= degrees < 180.
double bearing_deg(int bearing);
/// The bearing nearest to so many degrees of any number of turns.
int bearing_of_degrees(double degrees);

inline constexpr double step_unit_deg = 0.05625;  ///< of ScanSettings::step
inline constexpr int most_step = 255;             ///< it is a byte
/// ScanSettings::step of so many degrees; nullopt for what is no multiple of step_unit_deg, or too many.
std::optional<int> step_of_degrees(double degrees);

}  // namespace sonard::micron
