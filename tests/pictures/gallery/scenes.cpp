// SPDX-License-Identifier: Apache-2.0
#include "tests/pictures/gallery/scenes.hpp"

#include <limits>

namespace sonard::pictures {

const std::vector<GalleryScene>& gallery_scenes() {
  static const std::vector<GalleryScene> all{
      {.name = "docking_station", .config = "demo.yaml", .range_m = 25},
      {.name = "manifold", .config = "manifold.yaml", .range_m = 25},
      {.name = "ssiv", .config = "ssiv.yaml", .range_m = 20},
      {.name = "tank", .config = "demo-micron.yaml", .range_m = 12},
      {.name = "grid", .config = "grid-micron.yaml", .range_m = 8, .time_s = 10},  // when the turn begins
      {.name = "oil_and_gas", .config = "oil-and-gas-micron.yaml", .range_m = 12},
  };
  return all;
}

View view_of(const GalleryScene& scene) {
  return configured_view(scene.config, scene.range_m, scene.time_s);
}

void take_effects_off(View& view) {
  render::PhysicalModel& physical = view.settings.physical;
  physical.backscatter = render::PhysicalModel::Backscatter::lambert;
  physical.speckle.kind = render::SpeckleSettings::Kind::off;
  physical.noise.on = false;
  physical.speckle.texture_nu = 0;
  physical.water_clutter.density_per_m3 = 0;
  physical.volume_scattering_db = -std::numeric_limits<double>::infinity();
  physical.multipath.level = render::MultipathSettings::Level::off;
  physical.noise.broadside_stripe_db = 0;
  physical.ring_down.on = false;
  physical.noise.interference.probability = 0;
  physical.pulse.shape = render::PulseSettings::Shape::point;
  view.settings.aperture.azimuth = render::Aperture::Azimuth::ideal;
  view.settings.aperture.elevation = render::Aperture::Elevation::top_hat;
}

}  // namespace sonard::pictures
