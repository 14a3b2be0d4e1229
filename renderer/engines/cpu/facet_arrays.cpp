// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/facet_arrays.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/engines/cpu/facet_law.hpp"
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

/// Computed from the changes of direction d and normal n, both of unit length, in the middle; re a mirror
/// they differ by d - n or d + n. Incidences up to half the turn away count too: cos(phi - a) <= cos phi + a
/// sin phi.
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
    const float t = 0.5F * (low[i] + high[i]);
    const float n_h = at_h[i] + t_h[i] * t, n_s = at_s[i] + t_s[i] * t, n_z = at_z[i] + t_z[i] * t;
    const float per_d = 1 / std::sqrt(1 + t * t);
    const float per_n = 1 / std::sqrt(n_h * n_h + n_s * n_s + n_z * n_z);
    const float product = (n_h + n_z * t) * per_d * per_n;
    const float facing = std::copysign(per_n, product);
    const float u_h = n_h * per_n, u_s = n_s * per_n, u_z = n_z * per_n;
    // Along: d changes by the part of (0, 0, 1) across d, n by the part of per_t across n.
    const float d_t = t * per_d * per_d;  // (0, 0, 1) . d, divided by the length of q
    const float n_t = u_h * t_h[i] + u_s * t_s[i] + u_z * t_z[i];
    const float a_h = -d_t * per_d - (t_h[i] - u_h * n_t) * facing;
    const float a_s = -(t_s[i] - u_s * n_t) * facing;
    const float a_z = (1 - d_t * t) * per_d - (t_z[i] - u_z * n_t) * facing;
    // Across: (0, 1, 0) is across d.
    const float n_x = u_h * x_h[i] + u_s * x_s[i] + u_z * x_z[i];
    const float b_h = -(x_h[i] - u_h * n_x) * facing;
    const float b_s = per_d - (x_s[i] - u_s * n_x) * facing;
    const float b_z = -(x_z[i] - u_z * n_x) * facing;
    const float along = std::sqrt(a_h * a_h + a_s * a_s + a_z * a_z);
    const float across = std::sqrt(b_h * b_h + b_s * b_s + b_z * b_z) * width_rad;
    const float slope = std::sqrt(variance[i]);
    slopes_per_t[i] = along / slope;
    slopes_across[i] = across / slope;
    const float cosine = std::abs(product);
    const float sine2 = 1 - cosine * cosine;
    const float sine = std::sqrt(sine2 > 0 ? sine2 : 0.0F);
    const float half_turn = 0.5F * (along * (high[i] - low[i]) + across);
    responds[i] = cosine + half_turn * sine > least_cosine[i] ? 1.0F : 0.0F;
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
  // Gauss and Legendre's three points across, Simpson's along.
  constexpr std::size_t block = 16;
  constexpr float place = 0.38729833F, beside = 5.0F / 18, at_middle = 8.0F / 18;
  const float x = place * width_rad;
  const auto respond_to = [&](std::size_t i) __attribute__((always_inline)) {
    const auto sample = [&](float off, float t) __attribute__((always_inline)) {
      const float n_h = at_h[i] + x_h[i] * off + t_h[i] * t;
      const float n_s = at_s[i] + x_s[i] * off + t_s[i] * t;
      const float n_z = at_z[i] + x_z[i] * off + t_z[i] * t;
      const float product = n_h + n_s * off + n_z * t;
      const float c2 = product * product / ((n_h * n_h + n_s * n_s + n_z * n_z) * (1 + off * off + t * t));
      return facet_law(c2, strength[i], variance[i]);
    };
    const float t1 = low[i], t2 = high[i], tm = 0.5F * (t1 + t2);
    const float port1 = sample(x, t1), port_m = sample(x, tm), port2 = sample(x, t2);
    const float starboard1 = sample(-x, t1), starboard_m = sample(-x, tm), starboard2 = sample(-x, t2);
    const float mean1 = beside * (port1 + starboard1) + at_middle * sample(0.0F, t1);
    const float mean_m = beside * (port_m + starboard_m) + at_middle * sample(0.0F, tm);
    const float mean2 = beside * (port2 + starboard2) + at_middle * sample(0.0F, t2);
    mean[i] = (mean1 + 4 * mean_m + mean2) * (1.0F / 6);
    moment[i] = beside * place * (1.0F / 6) *
                ((port1 - starboard1) + 4 * (port_m - starboard_m) + (port2 - starboard2));
    gradient[i] = mean2 - mean1;
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
