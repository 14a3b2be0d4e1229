// Where the transducer looks from line to line (docs/protocols/micron.md 8.3).
#pragma once

#include "protocol/micron/device_config.hpp"
#include "protocol/micron/messages.hpp"
#include "protocol/micron/units.hpp"

namespace sonard::micron {

/// Bearings of a scan, in units, 0..6399. Knows no time.
class Sweep {
 public:
  explicit Sweep(LimitsOrder order) : order_(order) {}

  /// New parameters, taken up at `bearing`: a head that is outside its sector must go to the nearer limit
  /// first, one that stares to the left limit; bearing() is where it is then.
  void configure(const HeadCommand& command, int bearing);

  int bearing() const { return bearing_; }
  SweepCode code() const;
  /// Goes on to the next bearing and returns how far that is, in units. At a limit the scan turns round.
  int step();
  /// The scan turns round from its next step.
  void reverse() { clockwise_ = !clockwise_; }

 private:
  enum class Mode : std::uint8_t { still, sector, continuous };

  /// From the left limit clockwise, 0..6399.
  int offset() const { return wrapped(bearing_ - left_); }
  int nearer_limit(int bearing) const;

  LimitsOrder order_;
  Mode mode_ = Mode::still;
  bool clockwise_ = true;
  int left_ = 0;
  int width_ = 0;  ///< of the sector, clockwise from the left limit
  int step_ = 1;
  int bearing_ = bearing_ahead;
};

}  // namespace sonard::micron
