// SPDX-License-Identifier: Apache-2.0
// Bearings of the transducer from line to line (protocol/micron/README.md 8.3).
#pragma once

#include "protocol/micron/device_config.hpp"
#include "protocol/micron/messages.hpp"
#include "protocol/micron/units.hpp"

namespace sonard::micron {

inline constexpr int step_of_zero = 16;  ///< effective step if the command's step is 0

/// Sector between the limits of a head command, clockwise, in units.
struct Sector {
  int left = 0;   ///< 0..6399
  int width = 0;  ///< 0 if the limits are equal, 6400 if they are whole turns apart, else 1..6399

  int right() const { return wrapped(left + width); }
};
Sector sector_of(const HeadCommand& command, LimitsOrder order);
/// True if the head stays at the left limit: the stare bit is set, or the sector has no width.
bool stares(const HeadCommand& command);

/// Bearings of a scan, in units, 0..6399. Independent of time.
class Sweep {
 public:
  explicit Sweep(LimitsOrder order) : order_(order) {}

  /// Applies new parameters at `bearing`. If the head is outside its sector, bearing() is then the nearer
  /// limit; if it stares, the left limit. Otherwise bearing() does not change.
  void configure(const HeadCommand& command, int bearing);

  int bearing() const { return wrapped(sector_.left + offset_); }
  SweepCode code() const;
  /// Moves to the next bearing and returns the size of the step in units, >= 0. At a limit it reverses.
  int step();
  /// Reverses the scan from its next step on.
  void reverse() { clockwise_ = !clockwise_; }

 private:
  enum class Mode : std::uint8_t { still, sector, continuous };

  /// The offset of `bearing`, or of the nearer limit if it is outside the sector.
  int offset_of(int bearing) const;

  LimitsOrder order_;
  Mode mode_ = Mode::still;
  bool clockwise_ = true;
  Sector sector_;
  int offset_ = bearing_ahead;  ///< clockwise from the left limit; 0..width in a sector
  int step_ = 1;
};

}  // namespace sonard::micron
