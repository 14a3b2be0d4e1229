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
      {.name = "side_lobe_floor",
       .view = docking_station,
       .caption_before = "side_lobe_floor_db: 0 (off)",
       .before = [](View& view) { view.settings.physical.side_lobe_floor_db = 0; },
       .caption_after = "side_lobe_floor_db: -25",
       .after = [](View& view) { view.settings.physical.side_lobe_floor_db = -25; }},
  };
}

}  // namespace sonard::pictures
