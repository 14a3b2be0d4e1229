// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <utility>

#include <glm/gtc/quaternion.hpp>

#include "renderer/scene/primitives.hpp"
#include "tests/pictures/effects/effects.hpp"

namespace sonard::pictures {
namespace {

using render::PulseSettings;
using render::SpeckleSettings;

View docking_station() {
  return configured_view("demo.yaml", 20);
}

/// With a perfect array and sharp beams, so that only the effect fills shadows.
View sharp_docking_station(double range_m) {
  View view = configured_view("demo.yaml", range_m);
  view.settings.aperture.azimuth = render::Aperture::Azimuth::ideal;
  view.settings.aperture.elevation = render::Aperture::Elevation::top_hat;
  return view;
}

/// Lines of 3 mm on a bed.
View close_bed() {
  render::BodyPart bed;
  bed.mesh = std::make_shared<const render::TriangleMesh>(render::make_plane({20, 20}, {0, 0, 1}));
  bed.material.lambert_mu = 0.01;
  render::World world;
  world.bodies = {{"bed", {}, {bed}}};
  View view = plain_view(std::move(world), {{0, 0, 1}, glm::angleAxis(0.5, glm::dvec3(0, 1, 0))}, 3);
  view.settings.physical.gain_db += 6;
  return view;
}

/// The tank of the Micron, far beyond its walls and with more gain than needed.
View gained_tank() {
  View view = configured_view("demo-micron.yaml", 60);
  view.settings.physical.gain_db += 4;
  return view;
}

}  // namespace

std::vector<EffectPicture> receiver_pictures() {
  return {
      {.name = "noise",
       .view = [] { return configured_view("demo.yaml", 50); },
       .caption_before = "noise: off",
       .before = [](View& view) { view.settings.physical.noise.on = false; },
       .caption_after = "noise: on",
       .after = [](View& view) { view.settings.physical.noise.on = true; }},
      {.name = "speckle",
       .view = docking_station,
       .caption_before = "speckle: off",
       .before = [](View& view) { view.settings.physical.speckle.kind = SpeckleSettings::Kind::off; },
       .caption_after = "speckle: ou",
       .after = [](View& view) { view.settings.physical.speckle.kind = SpeckleSettings::Kind::ou; }},
      {.name = "range_correlation",
       .view = close_bed,
       .caption_before = "pulse: point",
       .before = [](View&) {},
       .caption_after = "pulse: chirp, with a cell of 40 mm",
       .after =
           [](View& view) {
             view.settings.physical.pulse.shape = PulseSettings::Shape::chirp;
             view.settings.physical.pulse.range_cell_m = 0.04;
           }},
      {.name = "texture",
       .view = close_bed,
       .caption_before = "texture_nu: 0 (off)",
       .before = [](View& view) { view.settings.physical.speckle.texture_nu = 0; },
       .caption_after = "texture_nu: 0.5",
       .after = [](View& view) { view.settings.physical.speckle.texture_nu = 0.5; }},
      {.name = "broadside_stripe",
       .view = [] { return configured_view("demo.yaml", 50); },
       .caption_before = "broadside_stripe_db: 0 (off)",
       .before = [](View& view) { view.settings.physical.noise.broadside_stripe_db = 0; },
       .caption_after = "broadside_stripe_db: 3.5",
       .after = [](View& view) { view.settings.physical.noise.broadside_stripe_db = 3.5; }},
      {.name = "ring_down",
       .view =
           [] {
             View view = configured_view("demo-micron.yaml", 5);
             view.settings.physical.gain_db += 20;
             return view;
           },
       .caption_before = "ring_down: off",
       .before = [](View& view) { view.settings.physical.ring_down.on = false; },
       .caption_after = "ring_down: on",
       .after = [](View& view) { view.settings.physical.ring_down.on = true; }},
      {.name = "interference",
       .view = gained_tank,
       .caption_before = "interference: 0",
       .before = [](View& view) { view.settings.physical.noise.interference.probability = 0; },
       .caption_after = "interference: 0.16",
       .after = [](View& view) { view.settings.physical.noise.interference.probability = 0.16; }},
      {.name = "volume_reverberation",
       .view =
           [] {
             View view = sharp_docking_station(40);
             view.settings.physical.noise.on = false;
             view.settings.physical.gain_db += 12;
             return view;
           },
       .caption_before = "volume_scattering_db: off",
       .before = [](View&) {},
       .caption_after = "volume_scattering_db: -50",
       .after = [](View& view) { view.settings.physical.volume_scattering_db = -50; }},
  };
}

}  // namespace sonard::pictures
