// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/slice_facets.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace sonard::render {

FacetSight::FacetSight(const Backscatter& backscatter, const NormalRun& normals, float width_rad,
                       float middle_t)
    : backscatter_(backscatter), normals_(normals), width_rad_(width_rad) {
  const glm::vec3 d = glm::normalize(glm::vec3(1, 0, middle_t)), n = normals_.at + middle_t * normals_.per_t;
  const float per_n = 1 / glm::length(n);
  const glm::vec3 n_unit = n * per_n;
  const glm::vec3 n_turn = (normals_.per_x - n_unit * glm::dot(n_unit, normals_.per_x)) * per_n;
  const glm::vec3 d_turn(0, d.x, 0);  // across d
  const float turn = glm::length(glm::dot(d, n) > 0 ? d_turn - n_turn : d_turn + n_turn);
  slopes_across_ = width_rad_ * turn / std::sqrt(backscatter_.slope_variance);
}

float FacetSight::cosine(float x, float t) const {
  const glm::vec3 n = normals_.at + x * normals_.per_x + t * normals_.per_t;
  const glm::vec3 d(1, x, t);
  return std::min(std::abs(glm::dot(n, d)) / std::sqrt(glm::dot(n, n) * glm::dot(d, d)), 1.0F);
}

/// On p = h (1, x, t) the surface is perpendicular to its normal: (ln h)' = -n_s / (n . q). The range is h
/// times the length of q.
float FacetSight::range_slope(float t, float place) const {
  constexpr float steepest = 10.0F;  // 84 degrees off: a silhouette
  const float x = place * width_rad_;
  const glm::vec3 q(1, x, t), n = normals_.at + x * normals_.per_x + t * normals_.per_t;
  const float slope = -n.y / glm::dot(n, q);
  return std::clamp(slope, -steepest, steepest) + x / glm::dot(q, q);
}

FacetResponse FacetSight::response(float t, const WedgePart& wedge) const {
  constexpr float even = 0.05F, nearly_even = 0.5F, per_stride = 2.5F;  // in rms slopes
  constexpr float most_strides = 32.0F;
  const float middle = 0.5F * (wedge.from + wedge.to), width = wedge.to - wedge.from;
  const float slopes = slopes_across_ * width;
  if (slopes < even) {
    return {backscatter_.facets(cosine(middle * width_rad_, t)), 0.0F};
  }
  FacetResponse sum;
  const auto sample = [&](float place, float weight) {
    const float echo = weight * backscatter_.facets(cosine((middle + place) * width_rad_, t));
    sum.mean += echo;
    sum.moment += echo * place;
  };
  // Gauss-Legendre: two points, or three per stride; over a stride the bell is smooth.
  if (slopes < nearly_even) {
    constexpr float off = 0.28867513F;
    sample(-off * width, 0.5F);
    sample(off * width, 0.5F);
    return sum;
  }
  constexpr float off = 0.38729833F, at_middle = 8.0F / 18, beside = 5.0F / 18;
  const float strides = std::clamp(std::ceil(slopes / per_stride), 1.0F, most_strides);
  for (float k = 0.5F; k < strides; ++k) {
    const float place = width * (k / strides - 0.5F), step = width / strides;
    sample(place - off * step, beside / strides);
    sample(place, at_middle / strides);
    sample(place + off * step, beside / strides);
  }
  return sum;
}

SegmentFacets facets_of_segment(const FacetSight& sight, const VisibleSegment& segment,
                                const WedgePart& wedge) {
  const FacetResponse low = sight.response(segment.low, wedge), high = sight.response(segment.high, wedge);
  const FacetResponse middle = sight.response(0.5F * (segment.low + segment.high), wedge);
  return {(low.mean + 4 * middle.mean + high.mean) * (1.0F / 6),
          (low.moment + 4 * middle.moment + high.moment) * (1.0F / 6), high.mean - low.mean};
}

}  // namespace sonard::render
