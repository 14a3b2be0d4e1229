// SPDX-License-Identifier: Apache-2.0
// A user's settings of a scan, and their conversion to a HeadCommand.
#pragma once

#include <optional>

#include "protocol/micron/messages.hpp"

namespace sonard::micron {

/// Sector clockwise from `left` to `right`, in units of the wire (protocol/micron/units.hpp), 0..6399; the
/// two must differ.
struct ScanSector {
  int left = 0;
  int right = 0;
};

struct ScanSettings {
  double range_m = 10.0;                            ///< > 0
  int bins = 400;                                   ///< 1..1500
  int step = 32;                                    ///< 1/16 gradian, 1..255
  std::optional<ScanSector> sector = std::nullopt;  ///< nullopt: all round
  bool clockwise = true;                            ///< direction; in a sector the first direction
  double gain_percent = 50.0;                       ///< 0..100
  bool eight_bit = true;                            ///< false: two bins per byte, in the window below
  double ad_low_db = 0.0;                           ///< 0..80
  double ad_span_db = 80.0;                         ///< 0..80
  double sound_speed_mps = 1500.0;                  ///< used to convert ranges; not sent to the head
};

/// Time between bins in units of 640 ns. Most drivers truncate it (protocol/micron/README.md 4), so the head
/// covers at most the requested range. May be outside 1..65535.
int ad_interval(const ScanSettings& settings);

/// Requires 1 <= ad_interval(settings) <= 65535.
HeadCommand make_head_command(const ScanSettings& settings);

/// Range extent of one bin, and of all bins, with these settings.
double bin_length_m(const ScanSettings& settings);
double covered_range_m(const ScanSettings& settings);

/// A bearing in degrees: 0 ahead, positive to starboard, -180 <= degrees < 180.
double bearing_deg(int bearing);
/// The bearing nearest to `degrees`, which may be any number of turns.
int bearing_of_degrees(double degrees);

inline constexpr double step_unit_deg = 0.05625;  ///< unit of ScanSettings::step
inline constexpr int most_step = 255;             ///< limit of a byte
/// ScanSettings::step for `degrees`; nullopt if it is not a multiple of step_unit_deg or out of range.
std::optional<int> step_of_degrees(double degrees);

}  // namespace sonard::micron
