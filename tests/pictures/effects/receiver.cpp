#include "tests/pictures/effects/effects.hpp"

namespace sonard::pictures {
namespace {

using render::PhysicalModel;

View docking_station() {
  return configured_view("demo.yaml", 20);
}

}  // namespace

std::vector<EffectPicture> receiver_pictures() {
  return {
      {.name = "noise",
       .view = [] { return configured_view("demo.yaml", 50); },
       .caption_before = "noise: off",
       .before = [](View& view) { view.settings.physical.noise = false; },
       .caption_after = "noise: on",
       .after = [](View& view) { view.settings.physical.noise = true; }},
      {.name = "speckle",
       .view = docking_station,
       .caption_before = "speckle: off",
       .before = [](View& view) { view.settings.physical.speckle = PhysicalModel::Speckle::off; },
       .caption_after = "speckle: ou",
       .after = [](View& view) { view.settings.physical.speckle = PhysicalModel::Speckle::ou; }},
      {.name = "range_grain",
       .view =
           [] {
             View view = configured_view("demo.yaml", 5);
             view.settings.range = {1000, 0.005, 0, false};
             return view;
           },
       .caption_before = "pulse: 0 mm",
       .before = [](View& view) { view.settings.physical.range_cell_m = 0; },
       .caption_after = "pulse: 20 mm",
       .after = [](View& view) { view.settings.physical.range_cell_m = 0.02; }},
      {.name = "texture",
       .view = docking_station,
       .caption_before = "texture_nu: 0 (off)",
       .before = [](View& view) { view.settings.physical.texture_nu = 0; },
       .caption_after = "texture_nu: 1",
       .after = [](View& view) { view.settings.physical.texture_nu = 1; }},
      {.name = "broadside_stripe",
       .view = [] { return configured_view("demo.yaml", 50); },
       .caption_before = "broadside_stripe_db: 0 (off)",
       .before = [](View& view) { view.settings.physical.broadside_stripe_db = 0; },
       .caption_after = "broadside_stripe_db: 3.5",
       .after = [](View& view) { view.settings.physical.broadside_stripe_db = 3.5; }},
      {.name = "ring_down",
       .view = [] { return configured_view("demo-micron.yaml", 5); },
       .caption_before = "ring_down: off",
       .before = [](View& view) { view.settings.physical.ring_down.on = false; },
       .caption_after = "ring_down: on",
       .after = [](View& view) { view.settings.physical.ring_down.on = true; }},
      {.name = "interference",
       .view = [] { return configured_view("demo-micron.yaml", 60); },
       .caption_before = "interference: 0",
       .before = [](View& view) { view.settings.physical.interference.probability = 0; },
       .caption_after = "interference: 0.07",
       .after = [](View& view) { view.settings.physical.interference.probability = 0.07; }},
      {.name = "volume_reverberation",
       .view = [] { return configured_view("demo.yaml", 30); },
       .caption_before = "volume_scattering_db: off",
       .before = [](View&) {},
       .caption_after = "volume_scattering_db: -55",
       .after = [](View& view) { view.settings.physical.volume_scattering_db = -55; }},
      {.name = "side_lobe_floor",
       .view = docking_station,
       .caption_before = "side_lobe_floor_db: 0 (off)",
       .before = [](View& view) { view.settings.physical.side_lobe_floor_db = 0; },
       .caption_after = "side_lobe_floor_db: -25",
       .after = [](View& view) { view.settings.physical.side_lobe_floor_db = -25; }},
  };
}

}  // namespace sonard::pictures
