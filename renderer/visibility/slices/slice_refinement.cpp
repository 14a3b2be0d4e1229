// Where slices have to be narrower.
#include <algorithm>
#include <cmath>

#include "renderer/simd.hpp"
#include "renderer/visibility/slices/slice_sampler_impl.hpp"

namespace sonard::render {

namespace {

constexpr int divisions_at_once = 4;

/// Share of the elevations at which two neighbours expect ranges more than a line apart on the border between
/// them. Ranges are secant / w: compared without dividing, and without those out of range in both.
SONARD_SIMD_CLONES
float disagreement(const SideProfile& a, const SideProfile& b, const SideProfile& secant, float line_m,
                   float furthest_m) {
  std::int32_t count = 0;
  for (std::size_t i = 0; i < side_probes; ++i) {
    const float w_a = a[i], w_b = b[i], scale = secant[i];
    const float nearer = w_a > w_b ? w_a : w_b;
    const float difference = scale * (w_a > w_b ? w_a - w_b : w_b - w_a);
    count += ((difference > line_m * w_a * w_b) & (scale < furthest_m * nearer)) ? 1 : 0;
  }
  return static_cast<float>(count) / side_probes;
}

SideProfile secants(float tan_limit) {
  SideProfile out;
  for (std::size_t i = 0; i < side_probes; ++i) {
    const float t = tan_limit * (2 * (static_cast<float>(i) + 0.5F) / side_probes - 1);
    out[i] = std::sqrt(1 + t * t);
  }
  return out;
}

}  // namespace

/// Chooses the slices on both sides of every border at which they disagree too much, and those that miss
/// something thin.
std::vector<std::uint8_t> SliceSampler::choose_to_divide(const Setting& setting) const {
  const SideProfile secant = secants(setting.fan.tan_limit());
  std::vector<std::uint8_t> divide(order_.size(), 0);
  const auto consider = [&](std::size_t i, float share) {
    const float width = setting.share_of_beam(*cells_[order_[i]]);
    divide[i] |= share * width > setting.accuracy.disagreement ? 1 : 0;
  };
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const SliceCell& cell = *cells_[order_[i]];
    divide[i] |= cell.misses_something ? 1 : 0;
    if (i + 1 < order_.size()) {
      const float share = disagreement(cell.starboard, cells_[order_[i + 1]]->port, secant, setting.line_m,
                                       setting.fan.max_range_m());
      consider(i, share);
      consider(i + 1, share);
    }
  }
  for (std::size_t i = 0; i < order_.size(); ++i) {
    // A slice that is as narrow as slices get stays as it is.
    const float width = setting.share_of_beam(*cells_[order_[i]]);
    divide[i] &= width * static_cast<float>(setting.accuracy.most_divisions) > 1.5F ? 1 : 0;
  }
  return divide;
}

/// @return whether anything was divided; `fresh` are the new cells.
bool SliceSampler::refine(const Setting& setting, std::vector<std::size_t>& fresh) {
  fresh.clear();
  if (setting.accuracy.most_divisions == 1) {
    return false;
  }
  const std::vector<std::uint8_t> divide = choose_to_divide(setting);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < order_.size(); ++i) {
    if (divide[i] == 0) {
      order.push_back(order_[i]);
      continue;
    }
    const Slice whole = cells_[order_[i]]->slice;
    const int beam = cells_[order_[i]]->beam;
    const double width = static_cast<double>(whole.width_rad);
    for (int k = 0; k < divisions_at_once; ++k) {
      const double azimuth_rad = whole.azimuth_rad + width * (0.5 - (k + 0.5) / divisions_at_once);
      order.push_back(new_cell({azimuth_rad, whole.width_rad / divisions_at_once}, beam));
      fresh.push_back(order.back());
    }
  }
  order_.swap(order);
  return !fresh.empty();
}

}  // namespace sonard::render
