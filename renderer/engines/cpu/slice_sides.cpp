// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/slice_sides.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

using slices::first_probe;
using slices::probe_at;
using slices::probe_step;

/// Computes shares and lines of SliceSides from its profiles. Ranges are positive, so their bit patterns have
/// the same order; GCC 12 vectorises extremes of integers only.
SONARD_SIMD_CLONES
void summarise(const SideView& view, SliceSides& sides) {
  const float* __restrict port = sides.port.data();
  const float* __restrict starboard = sides.starboard.data();
  const float* __restrict secant = view.secant.data();
  const std::int32_t* __restrict weight = view.weight.data();
  const float bins_end_m = view.bins_end_m;
  std::int32_t in_range_port = 0, in_range_starboard = 0;
  std::int32_t nearest = std::bit_cast<std::int32_t>(bins_end_m), furthest = 0;
  for (std::size_t i = 0; i < side_probes; ++i) {
    const float range_p = secant[i] / port[i], range_s = secant[i] / starboard[i];
    const bool in_p = secant[i] < bins_end_m * port[i], in_s = secant[i] < bins_end_m * starboard[i];
    in_range_port += in_p ? weight[i] : 0;
    in_range_starboard += in_s ? weight[i] : 0;
    const auto low_p = std::bit_cast<std::int32_t>(in_p ? range_p : bins_end_m);
    const auto low_s = std::bit_cast<std::int32_t>(in_s ? range_s : bins_end_m);
    const auto high_p = std::bit_cast<std::int32_t>(in_p ? range_p : 0.0F);
    const auto high_s = std::bit_cast<std::int32_t>(in_s ? range_s : 0.0F);
    const std::int32_t low = low_p < low_s ? low_p : low_s;
    const std::int32_t high = high_p > high_s ? high_p : high_s;
    nearest = low < nearest ? low : nearest;
    furthest = high > furthest ? high : furthest;
  }
  sides.ensonified =
      static_cast<float>(in_range_port + in_range_starboard) / (2 * side_probes * probe_weight_unit);
  sides.one_sided =
      static_cast<float>(std::abs(in_range_port - in_range_starboard)) / (side_probes * probe_weight_unit);
  const float span_m = std::bit_cast<float>(furthest) - std::bit_cast<float>(nearest);
  sides.lines = span_m > 0 ? span_m / view.line_m : 0.0F;
}

}  // namespace

SideView::SideView(const ProbeWeights& weight_, float tan_limit_, float bins_end_m_, float line_m_)
    : tan_limit(tan_limit_), bins_end_m(bins_end_m_), line_m(line_m_), secant(), weight(weight_) {
  for (std::size_t i = 0; i < side_probes; ++i) {
    const float t = probe_at(tan_limit, static_cast<int>(i));
    secant[i] = std::sqrt(1 + t * t);
  }
}

void SideExpectation::find(const std::vector<VisibleSegment>& visible, float width_rad, const SideView& view,
                           SliceSides& sides) {
  lay_out(visible);
  follow(width_rad, view.tan_limit);
  profile(view.tan_limit, 0.5F * width_rad, sides.port);
  profile(view.tan_limit, -0.5F * width_rad, sides.starboard);
  summarise(view, sides);
}

void SideExpectation::lay_out(const std::vector<VisibleSegment>& visible) {
  seen_.lay_out(visible);
  // w_per_azimuth_ grows last: if memory runs out before, the next call tries all again.
  if (seen_.size() > w_per_azimuth_.size()) {
    first_probe_.resize(seen_.size());
    last_probe_.resize(seen_.size());
    w_per_azimuth_.resize(seen_.size());
  }
}

/// Continues each segment beside the slice.
SONARD_SIMD_CLONES
void SideExpectation::follow(float width_rad, float tan_limit) {
  const auto count = seen_.count;
  const float* __restrict low = seen_.low.data();
  const float* __restrict high = seen_.high.data();
  float* __restrict low_slope = seen_.low_slope.data();
  float* __restrict high_slope = seen_.high_slope.data();
  const float* __restrict low_reach = seen_.low_reach.data();
  const float* __restrict high_reach = seen_.high_reach.data();
  const float* __restrict w_at_0 = seen_.w_at_0.data();
  const float* __restrict w_slope = seen_.w_slope.data();
  const float* __restrict normal_h = seen_.normal_h.data();
  const float* __restrict normal_s = seen_.normal_s.data();
  const float* __restrict normal_z = seen_.normal_z.data();
  float* __restrict w_per_azimuth = w_per_azimuth_.data();
  for (std::size_t i = 0; i < count; ++i) {
    low_slope[i] = slices::slope_within(low_slope[i], low_reach[i], low[i], width_rad, tan_limit);
    high_slope[i] = slices::slope_within(high_slope[i], high_reach[i], high[i], width_rad, tan_limit);
    w_per_azimuth[i] = slices::w_per_azimuth(w_at_0[i], w_slope[i], normal_h[i], normal_s[i], normal_z[i],
                                             0.5F * (low[i] + high[i]));
  }
}

/// Finds the probes of each segment at an offset from the slice, if it continues as in the middle.
SONARD_SIMD_CLONES
void SideExpectation::find_probes(float tan_limit, float offset_rad) {
  const auto count = seen_.count;
  const float* __restrict low = seen_.low.data();
  const float* __restrict high = seen_.high.data();
  const float* __restrict low_slope = seen_.low_slope.data();
  const float* __restrict high_slope = seen_.high_slope.data();
  std::int32_t* __restrict first = first_probe_.data();
  std::int32_t* __restrict last = last_probe_.data();
  for (std::size_t i = 0; i < count; ++i) {
    first[i] = slices::probe_above(low[i] + low_slope[i] * offset_rad, tan_limit);
    last[i] = slices::probe_above(high[i] + high_slope[i] * offset_rad, tan_limit);
  }
}

/// @param offset_rad from the middle of the slice, positive to port
void SideExpectation::profile(float tan_limit, float offset_rad, SideProfile& out) {
  const float step = probe_step(tan_limit);
  find_probes(tan_limit, offset_rad);
  std::int32_t end = 0;  // of the filled probes
  for (std::size_t i = 0; i < seen_.count; ++i) {
    const std::int32_t first = first_probe_[i], last = last_probe_[i];
    for (; end < first; ++end) {
      out[static_cast<std::size_t>(end)] = 0.0F;
    }
    const float slope = seen_.w_slope[i] * step;
    const float w = seen_.w_at_0[i] + w_per_azimuth_[i] * offset_rad +
                    seen_.w_slope[i] * (first_probe(tan_limit) + static_cast<float>(first) * step);
    // Most segments have one or two probes. The next segment, or the fill at the end, overwrites the excess.
    float* const at = &out[static_cast<std::size_t>(first)];
    for (std::int32_t k = 0; k < probe_padding; ++k) {
      at[k] = w + slope * static_cast<float>(k);
    }
    for (std::int32_t k = probe_padding; k < last - first; ++k) {
      at[k] = w + slope * static_cast<float>(k);
    }
    end = std::max(end, last);
  }
  std::fill(out.begin() + end, out.end(), 0.0F);
}

}  // namespace sonard::render
