// SPDX-License-Identifier: Apache-2.0
#include "tests/pictures/effects/effects.hpp"
#include "tests/scenes/scenes.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::pictures {

namespace {

using Level = render::MultipathSettings::Level;

void without(View& view) {
  view.settings.physical.multipath.level = Level::off;
}
void with(View& view) {
  view.settings.physical.multipath.level = Level::full;
  view.settings.physical.multipath.most_bounces = 6;
}

/// The tank of configs/worlds seen from above its floor along a wall: concrete, a steel ladder, water.
View tank() {
  View view = plain_view(render::load_world(SONARD_SOURCE_DIR "/configs/worlds/tank.sdf"),
                         {{-4, -2.5, -2.0}, {1, 0, 0, 0}}, 12);
  view.settings.aperture.vertical_beamwidth_rad = 0.7;
  view.settings.physical.gain_db = 44;
  return view;
}

/// The tank seen by a Micron with default settings.
View turn_in_the_tank() {
  View view = configured_view("demo-micron.yaml", 30);
  view.settings.physical.gain_db += 10;
  return view;
}

/// A sphere under calm water.
View sphere_under_water() {
  render::Body ball = test::make_body("ball", test::make_sphere(0.3F, 48), 0.03);
  ball.T_world_body.position_m = {15, 0, -3};
  render::World world = test::make_world({std::move(ball)});
  world.water_surface_z_m = 0;
  View view = plain_view(std::move(world), {{0, 0, -2}, {1, 0, 0, 0}}, 20);
  view.settings.aperture.vertical_beamwidth_rad = 0.8;
  view.settings.physical.multipath.water_surface_rms_height_m = 0;
  return view;
}

}  // namespace

std::vector<EffectPicture> multipath_pictures() {
  return {
      {.name = "multipath_tank",
       .view = tank,
       .caption_before = "multipath: level: off",
       .before = without,
       .caption_after = "level: full",
       .after = with},
      {.name = "bounces",
       .view = turn_in_the_tank,
       .caption_before = "multipath: most_bounces: 0",
       .before = [](View& view) { view.settings.physical.multipath.most_bounces = 0; },
       .caption_after = "most_bounces: 6",
       .after = [](View& view) { view.settings.physical.multipath.most_bounces = 6; }},
      {.name = "multipath_surface",
       .view = sphere_under_water,
       .caption_before = "multipath: level: off",
       .before = without,
       .caption_after = "level: full, calm water",
       .after = with},
  };
}

}  // namespace sonard::pictures
