// SPDX-License-Identifier: Apache-2.0
// How a material reflects in mode `physical`: Lambert's law and facets (docs/physics.md 2.4).
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// How the facets of materials are rendered.
enum class Facets {
  none,         ///< plain Lambert surfaces
  near_normal,  ///< left out if they echo less than 0.1 % of the Lambert part (SkipRule::facet_kernel)
  everywhere,   ///< at every incidence, and for materials without facets too
};

/// Facets echo s_b = |R|^2 / (8 pi m^2 cos^4 phi) exp(-tan^2 phi / (2 m^2)): high-frequency Kirchhoff theory,
/// for a surface with Gaussian slopes of rms m along each axis. Over a sphere of radius a, it integrates to
/// |R|^2 a^2 / 4.
struct Backscatter {
  static constexpr float widest_variance = 0.25F;  // m = 0.5: the law is invalid beyond

  float lambert_mu = 0.0F;
  float facet_strength = 0.0F;   ///< |R|^2 / (8 pi); 0: no facets
  float slope_variance = 0.04F;  ///< m^2
  float least_cosine = 2.0F;     ///< cos phi below which Facets::near_normal omits facets; 2: always

  Backscatter() = default;
  explicit Backscatter(const AcousticMaterial& material)
      : lambert_mu(static_cast<float>(material.lambert_mu)),
        facet_strength(static_cast<float>(material.pressure_reflection * material.pressure_reflection /
                                          (8 * std::numbers::pi))),
        slope_variance(static_cast<float>(material.rms_slope * material.rms_slope)),
        least_cosine(facet_strength > 0 ? cosine_of_negligible_facets() : 2.0F) {}

  /// Echo per solid angle at unit range, s_b / cos phi, of the Lambert part.
  float lambert(float cosine) const { return lambert_mu * cosine; }

  /// Echo per solid angle at unit range, s_b / cos phi, of the facets.
  /// @param added_variance variance of the slopes of a normal map, added to m^2
  float facets(float cosine, float added_variance = 0.0F) const {
    constexpr float as_good_as_none = 80.0F;  // exp(-80) counts as 0; avoids 0 / 0 at grazing incidence
    const float variance = std::min(slope_variance + added_variance, widest_variance);
    const float c2 = cosine * cosine;
    const float exponent = (1.0F - c2) / (2.0F * variance * c2);
    return exponent < as_good_as_none ? facet_strength / (variance * c2 * c2 * cosine) * std::exp(-exponent)
                                      : 0.0F;
  }

  bool has_facets(Facets which, float cosine) const {
    return which == Facets::everywhere || (which == Facets::near_normal && cosine > least_cosine);
  }

  /// The sum of both parts.
  float at(float cosine, Facets which) const {
    return lambert(cosine) + (has_facets(which, cosine) ? facets(cosine) : 0.0F);
  }

  /// Upper limit of at() over all incidences.
  float largest_response() const {
    // For m up to 0.5, facets echo at most 6 % more than at normal incidence.
    return lambert_mu + 1.06F * facet_strength / slope_variance;
  }

 private:
  /// Below this cosine facets are negligible: for any m up to 0.5, their share then decreases steadily.
  float cosine_of_negligible_facets() const {
    constexpr float negligible = 1e-3F;
    float least = 0.0F, most = 1.0F;
    for (int i = 0; i < 24; ++i) {
      const float middle = 0.5F * (least + most);
      (facets(middle) < negligible * lambert(middle) ? least : most) = middle;
    }
    return least;
  }
};

/// Variance along each axis of slopes that were averaged into a mean normal of this length. For Gaussian
/// slopes of variance v, the length is 1 / (1 + v) in first order (Toksvig 2005, "Mipmapping normal maps",
/// equation 2).
inline float variance_of_mean_normal(float length) {
  return length < 1.0F ? (1.0F - length) / std::max(length, 0.1F) : 0.0F;
}

}  // namespace sonard::render
