// Where the transducer looks from line to line (docs/protocols/micron.md 8.3).
#pragma once

#include "protocol/micron/device_config.hpp"
#include "protocol/micron/messages.hpp"
#include "protocol/micron/units.hpp"

namespace sonard::micron {

inline constexpr int step_of_zero = 16;  ///< what a step of 0 acts as

/// The sector of a head command, clockwise from its left limit: 0 where the limits are equal, 6400 where they
/// are a whole turn apart, 0..6399 otherwise.
int sector_width(const HeadCommand& command, LimitsOrder order);
/// Whether a head holds still at the left limit: it was told to stare, or to scan a sector of no width.
bool stares(const HeadCommand& command);

/// Bearings of a scan, in units, 0..6399. Knows no time.
class Sweep {
 public:
  explicit Sweep(LimitsOrder order) : order_(order) {}

  /// New parameters, taken up at `bearing`: a head that is outside its sector must go to the nearer limit
  /// first, one that stares to the left limit; bearing() is where it is then.
  void configure(const HeadCommand& command, int bearing);

  int bearing() const { return wrapped(left_ + offset_); }
  SweepCode code() const;
  /// Goes on to the next bearing and returns how far that is, in units. At a limit the scan turns round.
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
  int left_ = 0;
  int width_ = 0;               ///< of the sector, clockwise from the left limit; 6400: all round
  int offset_ = bearing_ahead;  ///< from the left limit clockwise, 0..width_ of a sector
  int step_ = 1;
};

}  // namespace sonard::micron
