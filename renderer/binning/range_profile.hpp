// SPDX-License-Identifier: Apache-2.0
// The sum of one beam's echo over range.
#pragma once

#include <cstddef>
#include <vector>

namespace sonard::render {

/// Sums amounts spread over range lines. It stores differences between lines, and second differences for
/// amounts with a gradient, so that an amount spread over many lines costs only its two ends. Every number is
/// a whole multiple of one unit, in a double below 2^53. Additions are therefore exact: the sum does not
/// depend on their order and is exactly 0 behind the last amount (docs/physics.md 4.2). Only one thread may
/// use it.
class RangeProfile {
 public:
  /// @param largest upper bound of the total, >= 0, in the unit of the amounts
  void reset(std::size_t lines, double largest);

  /// Adds `amount` spread between two positions in range lines, with a smear of each end and a gradient
  /// (EchoPatch). Parts outside the lines are dropped. An amount that begins within a thousandth of a line of
  /// the end of the last one is moved to that end, so that the two share a step. The gradient is not smeared;
  /// use it only for spreads above 0.02 lines and at least as large as the smears.
  void add(double position_a, float smear_a, double position_b, float smear_b, float amount, float gradient);
  /// Adds `amount` to one line. @param position in lines
  void add_point(double position, float amount);
  /// Adds the end of the last amount, which add() keeps back because the next amount may continue it.
  void finish();

  /// Writes the sum of every line. A negative sum becomes 0 and is taken from the lines beside it.
  void read(float* lines) const;

 private:
  void step(double position, float smear, double density);
  void step_from_before(double from, double smear, double density);
  double add_gradient(double from, double to, double slope);
  double add_slope_change(double position, double slope);

  std::size_t lines_ = 0;
  std::vector<double> difference_;
  std::vector<double> slope_change_;  ///< second difference
  bool has_slope_ = false;            ///< slope_change_ is not all 0
  double units_ = 1.0;                ///< per unit of the amounts
  // The far end of the last amount. If the next one begins there, both ends make one step.
  double open_position_ = 0.0;
  float open_smear_ = 0.0F;
  double open_density_ = 0.0;
};

}  // namespace sonard::render
