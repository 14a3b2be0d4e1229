// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/facet_arrays.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/engines/slices/slice_math.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

void FacetArrays::lay_out(const std::vector<VisibleSegment>& visible, const std::vector<PartSurface>& parts,
                          bool everywhere) {
  // responds_ grows last: if memory runs out before, the next call tries all again.
  if (visible.size() > responds_.size()) {
    for (auto* array : {&strength_, &variance_, &least_cosine_, &slopes_per_t_, &slopes_across_, &mean_,
                        &moment_, &gradient_, &responds_}) {
      array->resize(visible.size() + visible.size() / 2);
    }
  }
  for (std::size_t i = 0; i < visible.size(); ++i) {
    const PartSurface& part = parts[visible[i].part];
    const bool never = part.normal_map || (!everywhere && !(part.backscatter.facet_strength > 0));
    strength_[i] = never ? 0.0F : part.backscatter.facet_strength;
    variance_[i] = std::min(part.backscatter.slope_variance, Backscatter::widest_variance);
    least_cosine_[i] = never ? 1e9F : everywhere ? -1.0F : part.backscatter.least_cosine;
  }
}

SONARD_SIMD_CLONES
void FacetArrays::find_turns(const VisibleArrays& visible, const NormalArrays& normals, float width_rad) {
  const float* __restrict low = visible.low.data();
  const float* __restrict high = visible.high.data();
  const float* __restrict at_h = normals.at_h.data(), * __restrict at_s = normals.at_s.data(), * __restrict at_z = normals.at_z.data();
  const float* __restrict x_h = normals.h_per_x.data(), * __restrict x_s = normals.s_per_x.data(), * __restrict x_z = normals.z_per_x.data();
  const float* __restrict t_h = normals.h_per_t.data(), * __restrict t_s = normals.s_per_t.data(), * __restrict t_z = normals.z_per_t.data();
  const float* __restrict variance = variance_.data();
  const float* __restrict least_cosine = least_cosine_.data();
  float* __restrict responds = responds_.data();
  float* __restrict slopes_per_t = slopes_per_t_.data();
  float* __restrict slopes_across = slopes_across_.data();
  for (std::size_t i = 0; i < visible.count; ++i) {
    const slices::NormalField normal{at_h[i], at_s[i], at_z[i], x_h[i], x_s[i],
                                     x_z[i],  t_h[i],  t_s[i],  t_z[i]};
    const slices::FacetTurn turn = slices::turn_of_facets(normal, 0.5F * (low[i] + high[i]), width_rad);
    const float slope = std::sqrt(variance[i]);
    slopes_per_t[i] = turn.along_per_t / slope;
    slopes_across[i] = turn.across_rad / slope;
    responds[i] = slices::facets_may_respond(turn, high[i] - low[i], least_cosine[i]) ? 1.0F : 0.0F;
  }
}

SONARD_SIMD_CLONES
void FacetArrays::respond(const VisibleArrays& visible, const NormalArrays& normals, float width_rad) {
  const float* __restrict low = visible.low.data();
  const float* __restrict high = visible.high.data();
  const float* __restrict at_h = normals.at_h.data(), * __restrict at_s = normals.at_s.data(), * __restrict at_z = normals.at_z.data();
  const float* __restrict x_h = normals.h_per_x.data(), * __restrict x_s = normals.s_per_x.data(), * __restrict x_z = normals.z_per_x.data();
  const float* __restrict t_h = normals.h_per_t.data(), * __restrict t_s = normals.s_per_t.data(), * __restrict t_z = normals.z_per_t.data();
  const float* __restrict strength = strength_.data();
  const float* __restrict variance = variance_.data();
  const float* __restrict responds = responds_.data();
  float* __restrict mean = mean_.data();
  float* __restrict moment = moment_.data();
  float* __restrict gradient = gradient_.data();
  constexpr std::size_t block = 16;
  const auto respond_to = [&](std::size_t i) __attribute__((always_inline)) {
    const slices::NormalField normal{at_h[i], at_s[i], at_z[i], x_h[i], x_s[i],
                                     x_z[i],  t_h[i],  t_s[i],  t_z[i]};
    const slices::FacetResponse response =
        slices::facets_of_segment(normal, {strength[i], variance[i]}, low[i], high[i], width_rad);
    mean[i] = response.mean;
    moment[i] = response.moment;
    gradient[i] = response.gradient;
  };
  // Facets respond in runs of neighbours. The others are left out by whole blocks.
  for (std::size_t first = 0; first < visible.count; first += block) {
    const std::size_t end = std::min(first + block, visible.count);
    float any = 0.0F;
    for (std::size_t i = first; i < end; ++i) {
      any += responds[i];
    }
    if (any == 0.0F) {
      continue;
    }
    for (std::size_t i = first; i < end; ++i) {
      respond_to(i);
    }
  }
}

}  // namespace sonard::render
