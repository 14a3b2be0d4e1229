// SPDX-License-Identifier: Apache-2.0
// One beam's echo over range, being summed.
#pragma once

#include <cstddef>
#include <vector>

namespace sonard::render {

/// Sums amounts spread over range lines. What is kept is the difference from line to line, and for amounts
/// that rise or fall along the range its change, so that an amount spread over many lines costs no more than
/// its two ends. Every number is a whole multiple of one unit, held in a double below 2^53: additions are
/// exact, so the sum does not depend on their order, and where everything that begins has ended it is exactly
/// 0 (docs/physics.md 4.2). One thread uses it.
class RangeProfile {
 public:
  /// @param largest total that may be added, >= 0, in the unit of the amounts.
  void reset(std::size_t lines, double largest);

  /// Adds `amount` spread between two positions in range lines, of which each runs evenly over its smear, and
  /// with a gradient (EchoPatch). Positions may lie outside the lines: what falls there is dropped. An amount
  /// that begins within a thousandth of a line of where the last one ended begins there, so that the two
  /// share a step. The gradient is not smeared; it is for spreads above 0.02 lines and no less than the
  /// smears.
  void add(double position_a, float smear_a, double position_b, float smear_b, float amount, float gradient);
  /// Adds `amount` to the one line it falls into.
  void add_point(double position, float amount);
  /// Adds what the last add() has kept back: an end that the next patch might have continued.
  void finish();

  /// Writes the sum of every line; never negative. What a line lacks to nothing, the lines beside it give.
  void read(float* lines) const;

 private:
  void step(double position, float smear, double density);
  void step_from_before(double from, double smear, double density);
  double add_gradient(double from, double to, double slope);
  double add_slope_change(double position, double slope);

  std::size_t lines_ = 0;
  std::vector<double> difference_;
  std::vector<double> slope_change_;  ///< second difference
  bool has_slope_ = false;            ///< whether that has anything but zeros
  double units_ = 1.0;                ///< per unit of the amounts
  // The far end of the last patch. Where the next one begins at the same place the two make one step.
  double open_position_ = 0.0;
  float open_smear_ = 0.0F;
  double open_density_ = 0.0;
};

}  // namespace sonard::render
