// SPDX-License-Identifier: Apache-2.0
#include "renderer/binning/range_profile.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

constexpr int vector_lines = 4;                // lines of a smeared step that are added at a time
constexpr float least_smear = 1e-3F;           // lines; below, a step is sharp
constexpr double least_spread = 1e-3;          // lines; narrower amounts are widened to this
constexpr float widest_smear = 512.0F;         // lines; surfaces seen edge-on carry no energy
constexpr double total_units = 0x1p40;         // of `largest`; a patch of least_spread stays below 2^51
constexpr double round_to_integer = 0x1.8p52;  // adding and subtracting it rounds a double below 2^51

inline double rounded(double value) {
  return (value + round_to_integer) - round_to_integer;
}

/// Adds a smeared step to four differences; most steps change at most three. The step begins `from` lines
/// after the first of them; if `from` is negative, earlier calls have added its first part. An explicit
/// vector, because the compiler alone makes several; of four numbers, as in AVX2, because wider vectors than
/// the registers go through the stack at each operation.
[[gnu::always_inline]] inline void add_smeared_step(double from, double smear, double density,
                                                    double* difference) {
  using Lines = double __attribute__((vector_size(vector_lines * sizeof(double))));
  const Lines none{};
  const Lines whole = none + density;
  const Lines to = none + smear;
  const double half_over_smear = 0.5 / smear;
  // Integral from -infinity to y of a step that rises from 0 at 0 to 1 at `smear`.
  const auto integrate = [&](const Lines& y, Lines& integral) {
    const Lines begun = y > none ? y : none;
    const Lines rising = begun < to ? begun : to;
    integral = rising * rising * half_over_smear + (begun - rising);
  };
  // The integrals up to the begin of the line before each line, up to its own begin, and up to its end.
  const Lines y_before = Lines{-1, 0, 1, 2} - from;
  const Lines y_after = Lines{1, 2, 3, 4} - from;
  Lines before, after;
  integrate(y_before, before);
  integrate(y_after, after);
  const Lines here = __builtin_shufflevector(before, after, 1, 2, 3, 6);
  const Lines last = (density * (here - before) + round_to_integer) - round_to_integer;
  const Lines sum = (density * (after - here) + round_to_integer) - round_to_integer;
  Lines changed;
  std::memcpy(&changed, difference, sizeof changed);
  // Lines beyond the step get exactly its whole height, without rounding.
  const Lines y = __builtin_shufflevector(y_before, y_after, 1, 2, 3, 6);
  changed += (y >= to ? whole : sum) - (y_before >= to ? whole : last);
  std::memcpy(difference, &changed, sizeof changed);
}

}  // namespace

void RangeProfile::reset(std::size_t lines, double largest) {
  lines_ = lines;
  difference_.assign(lines + static_cast<std::size_t>(vector_lines), 0.0);
  if (has_slope_ || slope_change_.size() != lines) {
    slope_change_.assign(lines, 0.0);
    has_slope_ = false;
  }
  units_ = largest > 0 ? std::exp2(std::floor(std::log2(total_units / largest))) : 1.0;
  open_density_ = 0.0;
}

// Flattened, so that the vectors of a patch stay within one function.
[[gnu::flatten]] SONARD_SIMD_CLONES void RangeProfile::add(double position_a, float smear_a,
                                                           double position_b, float smear_b, float amount,
                                                           float relative_gradient) {
  // Equal ends become one step. The patch is moved to the end of the last one before its spread is computed:
  // moving an end afterwards would change the amount.
  const bool joined = open_density_ != 0.0 && std::abs(open_position_ - position_a) < least_spread &&
                      std::abs(open_smear_ - smear_a) < least_smear * (1 + smear_a);
  if (joined) {
    position_a = open_position_;
    smear_a = open_smear_;
  }
  double spread = position_b - position_a;
  if (std::abs(spread) < least_spread) {
    spread = std::copysign(least_spread, spread);
    position_b = position_a + spread;
  }
  // Negative if the far end comes first; the signs of the two steps then swap.
  const double mean = static_cast<double>(amount) * units_ / spread;
  const bool has_gradient = relative_gradient != 0.0F && position_a >= 0 && position_b >= 0;
  const double change = has_gradient ? mean * static_cast<double>(relative_gradient) : 0.0;
  const double density = rounded(mean - change);
  if (joined) {
    step(position_a, smear_a, density + open_density_);
  } else {
    finish();
    step(position_a, smear_a, density);
  }
  open_position_ = position_b;
  open_smear_ = smear_b;
  open_density_ = -density;
  if (has_gradient) {
    open_density_ -= add_gradient(position_a, position_b, rounded(2 * change / spread));
  }
}

/// Adds a linear rise of the density from one position to another.
/// @return the rise, a whole number of units
double RangeProfile::add_gradient(double from, double to, double slope) {
  has_slope_ = true;
  return add_slope_change(from, slope) + add_slope_change(to, -slope) +
         slope * (std::floor(to) - std::floor(from));
}

/// Adds a change of the density's slope at a position.
/// @return the offset c: the n-th line after the position's line gets slope * n + c
double RangeProfile::add_slope_change(double position, double slope) {
  const double line = std::floor(position);
  const double left = line + 1 - position;
  const double in_line = rounded(slope * (0.5 * left * left));
  const double in_next = rounded(slope * (left + 0.5));
  const auto add = [&](double at, double amount) {
    if (at < static_cast<double>(lines_)) {
      slope_change_[static_cast<std::size_t>(at)] += amount;
    }
  };
  add(line, in_line);
  add(line + 1, in_next - 2 * in_line);
  add(line + 2, slope - in_next + in_line);
  return in_next - slope;
}

void RangeProfile::finish() {
  if (open_density_ != 0.0) {
    step(open_position_, open_smear_, open_density_);
    open_density_ = 0.0;
  }
}

void RangeProfile::step(double position, float smear, double density) {
  if (!(density != 0.0)) {
    return;
  }
  const auto wide = static_cast<double>(std::clamp(smear, least_smear, widest_smear));
  const double from = position - 0.5 * wide;
  if (!(from < static_cast<double>(lines_))) {
    return;
  }
  if (from + wide <= 0) {
    difference_[0] += density;
    return;
  }
  if (from < 0) {
    step_from_before(from, wide, density);
    return;
  }
  auto line = static_cast<std::size_t>(from);
  double offset = from - static_cast<double>(line);
  do {
    add_smeared_step(offset, wide, density, &difference_[line]);
    line += static_cast<std::size_t>(vector_lines);
    offset -= vector_lines;
  } while (offset + wide > -1 && line < lines_);
}

/// Adds a step that begins before the first line and ends behind its beginning.
void RangeProfile::step_from_before(double from, double smear, double density) {
  // Integral of the step from -infinity to the beginning of line k.
  const auto integral_to = [&](std::size_t k) {
    const double y = static_cast<double>(k) - from;
    const double rising = std::clamp(y, 0.0, smear);
    return 0.5 * rising * rising / smear + std::max(0.0, y - smear);
  };
  const auto end = static_cast<std::size_t>(std::min(static_cast<double>(lines_), std::ceil(from + smear)));
  double before = integral_to(0);
  double last = 0.0;
  for (std::size_t k = 0; k < end; ++k) {
    const double after = integral_to(k + 1);
    const double sum = rounded(density * (after - before));
    difference_[k] += sum - last;
    last = sum;
    before = after;
  }
  difference_[end] += density - last;
}

void RangeProfile::add_point(double position, float amount) {
  if (!(position >= 0) || !(position < static_cast<double>(lines_))) {
    return;
  }
  const auto line = static_cast<std::size_t>(position);
  const double units = rounded(static_cast<double>(amount) * units_);
  difference_[line] += units;
  difference_[line + 1] -= units;
}

// If the ends of a patch cross, it is negative on one side and as much too large on the other. Neighbouring
// patches usually compensate this; otherwise the lines beside it do, so that the beam keeps its whole echo.
void RangeProfile::read(float* lines) const {
  const double unit = 1.0 / units_;  // a power of two
  double missing = 0.0;
  std::size_t end = 0;  // end of the earlier lines from which a deficit can be taken
  const auto write = [&](std::size_t k, double sum) {
    double left = sum * unit - missing;
    lines[k] = left > 0 ? static_cast<float>(left) : 0.0F;
    missing = 0.0;
    if (!(left < 0)) {
      end = k + 1;
      return;
    }
    while (left < 0 && end > 0 && lines[end - 1] > 0) {
      left += static_cast<double>(lines[end - 1]);
      lines[end - 1] = left > 0 ? static_cast<float>(left) : 0.0F;
      end -= left > 0 ? 0 : 1;
    }
    if (left < 0 && sum != 0) {
      missing = -left;  // taken from the next lines
    }
  };
  double sum = 0.0;
  if (!has_slope_) {
    for (std::size_t k = 0; k < lines_; ++k) {
      write(k, sum += difference_[k]);
    }
    return;
  }
  double slope = 0.0;
  for (std::size_t k = 0; k < lines_; ++k) {
    slope += slope_change_[k];
    write(k, sum += difference_[k] + slope);
  }
}

}  // namespace sonard::render
