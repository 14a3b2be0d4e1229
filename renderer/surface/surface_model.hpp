// SPDX-License-Identifier: Apache-2.0
// The response of a surface in either model.
#pragma once

#include <cmath>

#include "renderer/scene/world.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/sonar_settings.hpp"
#include "renderer/surface/backscatter.hpp"

namespace sonard::render {

/// The law that turns incidence into a response: echo per solid angle at unit range.
struct SurfaceModel {
  Model model = Model::physical;
  Facets facets = Facets::none;  ///< only with `physical`
  /// `physical`: response = s_b / cos phi: Lambert's mu cos phi, plus the facets of Backscatter. `paper`:
  /// response = sigmoid(min(1, rho |cos phi| exp(-2 a r))).
  double sigmoid_slope = 18.0;
  double sigmoid_centre = 2.0 / 3.0;
  double attenuation_per_m = 0.0;
  bool two_sided = true;
};

/// Response of mode `paper`, for a surface of this reflectance at cos phi = `cosine`. NaN gives NaN.
inline float paper_response(const SurfaceModel& model, float reflectance, float cosine, float range_m) {
  float echo = reflectance * cosine;
  if (model.attenuation_per_m != 0.0) {
    echo *= std::exp(static_cast<float>(-2.0 * model.attenuation_per_m) * range_m);
  }
  const auto slope = static_cast<float>(model.sigmoid_slope);
  const auto centre = static_cast<float>(model.sigmoid_centre);
  return 1.0F / (1.0F + std::exp(slope * (centre - (echo > 1.0F ? 1.0F : echo))));
}

/// The model in the settings. SkipRule::facet_kernel omits weak facets.
SurfaceModel surface_model(const SonarSettings& settings, const SkipSwitches& skip);

/// The largest response of all surfaces of a world, in either model: mu <= 1/pi, and the sigmoid is at
/// most 1.
float largest_response(const World& world);

}  // namespace sonard::render
