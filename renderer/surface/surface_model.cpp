// SPDX-License-Identifier: Apache-2.0
#include "renderer/surface/surface_model.hpp"

#include <algorithm>

namespace sonard::render {

SurfaceModel surface_model(const SonarSettings& settings, const SkipSwitches& skip) {
  SurfaceModel surface;
  surface.model = settings.model;
  if (settings.model == Model::physical &&
      settings.physical.backscatter == PhysicalModel::Backscatter::lambert_facet) {
    surface.facets = skip.on(SkipRule::facet_kernel) ? Facets::near_normal : Facets::everywhere;
  }
  if (settings.model == Model::paper) {
    surface.sigmoid_slope = settings.paper.sigmoid_slope;
    surface.sigmoid_centre = settings.paper.sigmoid_centre;
    surface.attenuation_per_m = settings.paper.attenuation_per_m;
    surface.two_sided = settings.paper.two_sided;
  }
  return surface;
}

float largest_response(const World& world) {
  float largest = 1.0F;
  for (const Body& body : world.bodies) {
    for (const BodyPart& part : body.parts) {
      largest = std::max(largest, Backscatter(part.material).largest_response());
    }
  }
  return largest;
}

}  // namespace sonard::render
