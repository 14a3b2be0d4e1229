// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/slice_facets.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

#include "renderer/engines/slices/slice_math.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

constexpr std::size_t lanes = 16;  // samples are computed so many at a time
constexpr std::size_t most_strides = 32;
constexpr std::size_t most_places = 3 * most_strides;  // per part
constexpr std::size_t most_samples = most_places * FacetSight::most_parts;

/// Places across a part, from its middle and in widths of the part, and their shares of the mean.
struct Quadrature {
  std::size_t count = 0;
  std::array<float, most_places> place, weight;

  /// @param slopes turn of the echo's direction across the part, in rms slopes m
  explicit Quadrature(float slopes) {
    constexpr float even = 0.05F, nearly_even = 0.5F, per_stride = 2.5F;
    // Gauss-Legendre: one point, two points, or three per stride; over a stride the bell is smooth.
    if (slopes < even) {
      add(0.0F, 1.0F);
    } else if (slopes < nearly_even) {
      constexpr float off = 0.28867513F;
      add(-off, 0.5F);
      add(off, 0.5F);
    } else {
      constexpr float off = 0.38729833F, at_middle = 8.0F / 18, beside = 5.0F / 18;
      const float strides =
          std::clamp(std::ceil(slopes / per_stride), 1.0F, static_cast<float>(most_strides));
      for (int k = 0; k < static_cast<int>(strides); ++k) {
        const float middle = (static_cast<float>(k) + 0.5F) / strides - 0.5F;
        add(middle - off / strides, beside / strides);
        add(middle, at_middle / strides);
        add(middle + off / strides, beside / strides);
      }
    }
  }

 private:
  void add(float at, float share) {
    place[count] = at;
    weight[count++] = share;
  }
};

struct FacetsAt {
  const NormalRun& normals;
  float strength, variance;
};

/// The response at azimuths x of the slice, and at t.
/// @param count a multiple of `lanes`
SONARD_SIMD_CLONES
void respond_at(const FacetsAt& facets, float t, const float* __restrict x, std::size_t count,
                float* __restrict response) {
  const glm::vec3 n = facets.normals.at + t * facets.normals.per_t, per_x = facets.normals.per_x;
  const slices::FacetMaterial material{facets.strength, facets.variance};
  for (std::size_t i = 0; i < count; ++i) {
    response[i] = slices::facets_toward(n.x + x[i] * per_x.x, n.y + x[i] * per_x.y, n.z + x[i] * per_x.z,
                                        x[i], t, material);
  }
}

}  // namespace

float FacetSight::range_slope(float t, float place) const {
  const auto& [at, per_x, per_t] = normals_;
  return slices::range_slope({at.x, at.y, at.z, per_x.x, per_x.y, per_x.z, per_t.x, per_t.y, per_t.z},
                             place * width_rad_, t);
}

void FacetSight::respond(const VisibleSegment& segment, std::span<SegmentFacets> facets) const {
  const auto parts = static_cast<float>(facets.size());
  const Quadrature across(slopes_across_ / parts);
  alignas(64) std::array<float, most_samples> x;
  std::size_t samples = 0;
  for (std::size_t part = 0; part < facets.size(); ++part) {
    const float middle = (static_cast<float>(part) + 0.5F) / parts - 0.5F;
    for (std::size_t k = 0; k < across.count; ++k) {
      x[samples++] = (middle + across.place[k] / parts) * width_rad_;
    }
  }
  while (samples % lanes != 0) {
    x[samples++] = 0.0F;
  }
  const FacetsAt at{normals_, backscatter_.facet_strength,
                    std::min(backscatter_.slope_variance, Backscatter::widest_variance)};
  const std::array<float, 3> t{segment.low, 0.5F * (segment.low + segment.high), segment.high};
  constexpr std::array<float, 3> mean_share{1.0F / 6, 4.0F / 6, 1.0F / 6}, gradient_share{-1.0F, 0.0F, 1.0F};
  std::ranges::fill(facets, SegmentFacets{});
  alignas(64) std::array<float, most_samples> response;
  for (std::size_t i = 0; i < t.size(); ++i) {
    respond_at(at, t[i], x.data(), samples, response.data());
    const float* of_part = response.data();
    for (SegmentFacets& sum : facets) {
      float mean = 0.0F, moment = 0.0F;
      for (std::size_t k = 0; k < across.count; ++k) {
        const float echo = across.weight[k] * of_part[k];
        mean += echo;
        moment += echo * across.place[k];
      }
      sum.mean += mean_share[i] * mean;
      sum.moment += mean_share[i] / parts * moment;
      sum.gradient += gradient_share[i] * mean;
      of_part += across.count;
    }
  }
}

}  // namespace sonard::render
