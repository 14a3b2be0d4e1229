// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "tests/pictures/effects/effects.hpp"
#include "tests/scenes/shapes.hpp"
#include "tests/support/degree.hpp"

namespace sonard::pictures {
namespace {

render::BodyPart part_of(render::TriangleMesh mesh, double lambert_mu) {
  render::BodyPart part;
  part.mesh = std::make_shared<const render::TriangleMesh>(std::move(mesh));
  part.material.lambert_mu = lambert_mu;
  return part;
}

/// Without speckle and noise, which do not show ranges.
View smooth_view() {
  View view = configured_view("demo.yaml", 20);
  view.settings.physical.speckle.kind = render::SpeckleSettings::Kind::off;
  view.settings.physical.noise.on = false;
  return view;
}

/// Five boxes on a flat bed, seen from 5 m above it with a narrow level beam.
View long_view() {
  render::World world;
  render::TriangleMesh bed;
  bed.positions = {{-5, -110, 0}, {120, -110, 0}, {120, 110, 0}, {-5, 110, 0}};
  bed.indices = {0, 1, 2, 0, 2, 3};
  world.bodies.push_back({"bed", {}, {part_of(std::move(bed), 0.02)}});
  for (int i = 0; i < 5; ++i) {
    const double bearing = (40 - 20 * i) * degree;
    const double range_m = 45 + 8 * i;
    const glm::dvec3 centre_m(range_m * std::cos(bearing), range_m * std::sin(bearing), 0.75);
    world.bodies.push_back(
        {"box " + std::to_string(i), {}, {part_of(test::make_block(centre_m, {3, 3, 1.5}, bearing), 0.1)}});
  }
  View view = plain_view(std::move(world), {{0, 0, 5}, {1, 0, 0, 0}}, 100);
  view.settings.aperture.vertical_beamwidth_rad = 8 * degree;
  view.settings.physical.noise.on = false;
  view.settings.physical.gain_db += 10;
  return view;
}

}  // namespace

std::vector<EffectPicture> propagation_pictures() {
  return {
      {.name = "sound_speed",
       .view = smooth_view,
       .caption_before = "sound as fast as assumed",
       .before = [](View&) {},
       .caption_after = "7 % slower",
       .after =
           [](View& view) {
             view.settings.range.step_m *= 0.93;
             view.display_scale = 1 / 0.93;
           }},
      {.name = "motion_within_ping",
       .view = [] { return configured_view("demo.yaml", 30); },
       .caption_before = "at rest",
       .before = [](View&) {},
       .caption_after = "turning to port, 100 degrees/s",
       .after =
           [](View& view) {
             view.T_world_sonar_at_end = view.T_world_sonar;
             view.T_world_sonar_at_end->orientation =
                 glm::angleAxis(100 * degree * 60 / 1500, glm::dvec3(0, 0, 1)) *
                 view.T_world_sonar.orientation;
           }},
      {.name = "refraction",
       .view = long_view,
       .caption_before = "straight rays",
       .before = [](View&) {},
       .caption_after = "1.8 m/s faster per metre up",
       .after = [](View& view) { view.ray_curvature_per_m = 1.8 / 1500; }},
  };
}

}  // namespace sonard::pictures
