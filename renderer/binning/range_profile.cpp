#include "renderer/binning/range_profile.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

constexpr std::size_t vector_lines = 8;        // a step smeared over no more than these is added at once
constexpr float least_smear = 1e-3F;           // lines; below, a step is sharp
constexpr double least_spread = 1e-3;          // lines; what is narrower is widened to this
constexpr float widest_smear = 512.0F;         // lines; surfaces seen edge-on carry no energy
constexpr double total_units = 0x1p40;         // of `largest`; a patch of least_spread stays below 2^51
constexpr double round_to_integer = 0x1.8p52;  // adding and subtracting it rounds a double below 2^51

/// Integral from -infinity to y of a step that rises from 0 at 0 to 1 at `smear`.
inline float integral_of_step(float y, float smear, float half_over_smear) {
  const float rising = y < 0 ? 0.0F : (y < smear ? y : smear);
  const float above = y > smear ? y - smear : 0.0F;
  return rising * rising * half_over_smear + above;
}

/// Adds a smeared step to eight lines and the ninth difference. `from` is where it begins, relative to the
/// first.
SONARD_SIMD_CLONES
void add_short_step(float from, float smear, double density, double* difference) {
  const float half_over_smear = 0.5F / smear;
  float integral[vector_lines + 1];
  double sum[vector_lines + 1];
  for (std::size_t k = 0; k <= vector_lines; ++k) {
    integral[k] = integral_of_step(static_cast<float>(k) - from, smear, half_over_smear);
  }
  sum[0] = 0.0;
  for (std::size_t k = 0; k < vector_lines; ++k) {
    const bool whole = static_cast<float>(k) >= from + smear;
    const double part =
        (density * static_cast<double>(integral[k + 1] - integral[k]) + round_to_integer) - round_to_integer;
    sum[k + 1] = whole ? density : part;
  }
  for (std::size_t k = 0; k < vector_lines; ++k) {
    difference[k] += sum[k + 1] - sum[k];
  }
  difference[vector_lines] += density - sum[vector_lines];
}

}  // namespace

void RangeProfile::reset(std::size_t lines, double largest) {
  lines_ = lines;
  difference_.assign(lines + vector_lines + 1, 0.0);
  units_ = largest > 0 ? std::exp2(std::floor(std::log2(total_units / largest))) : 1.0;
  open_density_ = 0.0;
}

void RangeProfile::add(double position_a, float smear_a, double position_b, float smear_b, float amount) {
  // Two ends become one step where they are the same. The patch then begins where the last one ended, before
  // its spread is taken: moving an end afterwards would change the amount.
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
  // Negative where the far end comes first: the two steps then change places by themselves.
  const double density =
      (static_cast<double>(amount) * units_ / spread + round_to_integer) - round_to_integer;
  if (joined) {
    step(position_a, smear_a, density + open_density_);
  } else {
    finish();
    step(position_a, smear_a, density);
  }
  open_position_ = position_b;
  open_smear_ = smear_b;
  open_density_ = -density;
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
  const float wide = std::clamp(smear, least_smear, widest_smear);
  const double from = position - 0.5 * static_cast<double>(wide);
  if (!(from < static_cast<double>(lines_))) {
    return;
  }
  if (from + static_cast<double>(wide) <= 0) {
    difference_[0] += density;
  } else if (from >= 0 && wide < static_cast<float>(vector_lines) - 1) {
    const auto first = static_cast<std::size_t>(from);
    add_short_step(static_cast<float>(from - static_cast<double>(first)), wide, density, &difference_[first]);
  } else {
    step_slow(from, wide, density);
  }
}

void RangeProfile::step_slow(double from, float smear, double density) {
  const float half_over_smear = 0.5F / smear;
  const auto first = static_cast<std::size_t>(std::max(0.0, from));
  const auto end = static_cast<std::size_t>(
      std::min(static_cast<double>(lines_), std::ceil(from + static_cast<double>(smear))));
  const auto integral_to = [&](std::size_t k) {
    return integral_of_step(static_cast<float>(static_cast<double>(k) - from), smear, half_over_smear);
  };
  float before = integral_to(first);
  double last = 0.0;
  for (std::size_t k = first; k < end; ++k) {
    const float after = integral_to(k + 1);
    const double sum = std::nearbyint(density * static_cast<double>(after - before));
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
  const double units = std::nearbyint(static_cast<double>(amount) * units_);
  difference_[line] += units;
  difference_[line + 1] -= units;
}

void RangeProfile::read(float* lines) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < lines_; ++k) {
    sum += difference_[k];
    // Ends that cross within a patch leave a little less than nothing where it is thinnest.
    lines[k] = sum > 0 ? static_cast<float>(sum / units_) : 0.0F;
  }
}

}  // namespace sonard::render
