// SPDX-License-Identifier: Apache-2.0
// Where the transducer looks from line to line (docs/protocols/micron.md 8.3).
#pragma once

#include "protocol/micron/device_config.hpp"
#include "protocol/micron/messages.hpp"
#include "protocol/micron/units.hpp"

namespace sonard::micron {

inline constexpr int step_of_zero = 16;  ///< what a step of 0 acts as

/// Between the limits of a head command, clockwise, in units.
struct Sector {
  int left = 0;   ///< 0..6399
  int width = 0;  ///< 0 where the limits are equal, 6400 where they are a whole turn apart, else 1..6399

  int right() const { return wrapped(left + width); }
};
Sector sector_of(const HeadCommand& command, LimitsOrder order);
/// Whether a head holds still at the left limit: it was told to stare, or to scan a sector of no width.
bool stares(const HeadCommand& command);

/// Bearings of a scan, in units, 0..6399. Knows no time.
class Sweep {
 public:
  explicit Sweep(LimitsOrder order) : order_(order) {}

  /// New parameters, taken up at `bearing`: a head that is outside its sector must go to the nearer limit
  /// first, one that stares to the left limit; bearing() is where it is then.
  void configure(const HeadCommand& command, int bearing);

  int bearing() const { return wrapped(sector_.left + offset_); }
  SweepCode code() const;
  /// Moves to the next bearing and returns how far that is, in units. At a limit the scan reverses.
  int step();
  /// The scan turns round from its next step.
  void reverse() { clockwise_ = !clockwise_; }

 private:
  enum class Mode : std::uint8_t { still, sector, continuous };

  /// Into the sector, from anywhere.
  int offset_of(int bearing) const;

  LimitsOrder order_;
  Mode mode_ = Mode::still;
  bool clockwise_ = true;
  Sector sector_;
  int offset_ = bearing_ahead;  ///< from the left limit clockwise, within a sector 0..width
  int step_ = 1;
};

}  // namespace sonard::micron
