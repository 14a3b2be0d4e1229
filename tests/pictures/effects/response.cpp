// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "tests/pictures/effects/effects.hpp"

namespace sonard::pictures {
namespace {

/// Up to 20 m, with a receive array without errors.
View perfect_docking_station() {
  View view = configured_view("demo.yaml", 20);
  view.settings.aperture.element_amplitude_sd = 0;
  view.settings.aperture.element_phase_sd_rad = 0;
  view.settings.physical.noise.on = false;  // noise makes pictures large
  return view;
}

}  // namespace

std::vector<EffectPicture> response_pictures() {
  using Azimuth = render::Aperture::Azimuth;
  using Elevation = render::Aperture::Elevation;
  using Backscatter = render::PhysicalModel::Backscatter;
  using Shape = render::PulseSettings::Shape;
  return {
      {.name = "facets",
       .view = [] { return configured_view("demo-micron.yaml", 12); },
       .caption_before = "backscatter: lambert",
       .before = [](View& view) { view.settings.physical.backscatter = Backscatter::lambert; },
       .caption_after = "backscatter: lambert_facet",
       .after = [](View& view) { view.settings.physical.backscatter = Backscatter::lambert_facet; }},
      {.name = "azimuth_pattern",
       .view = perfect_docking_station,
       .caption_before = "azimuth_pattern: ideal",
       .before = [](View& view) { view.settings.aperture.azimuth = Azimuth::ideal; },
       .caption_after = "azimuth_pattern: array",
       .after = [](View& view) { view.settings.aperture.azimuth = Azimuth::array; }},
      {.name = "element_errors",
       .view =
           [] {
             View view = perfect_docking_station();
             view.settings.physical.speckle.kind = render::SpeckleSettings::Kind::off;
             return view;
           },
       .caption_before = "element_amplitude_sd: 0, element_phase_sd_deg: 0",
       .before = [](View&) {},
       .caption_after = "element_amplitude_sd: 0.24, element_phase_sd_deg: 14",
       .after =
           [](View& view) {
             view.settings.aperture.element_amplitude_sd = 0.24;
             view.settings.aperture.element_phase_sd_rad = 20 * std::numbers::pi / 180;
           }},
      {.name = "pulse",
       .view =
           [] {
             View view = configured_view("demo.yaml", 20);
             view.settings.physical.noise.on = false;  // noise makes pictures large
             view.settings.physical.speckle.kind = render::SpeckleSettings::Kind::off;
             return view;
           },
       .caption_before = "pulse: point",
       .before = [](View& view) { view.settings.physical.pulse.shape = Shape::point; },
       .caption_after = "pulse: tone, of 128 cycles",
       .after =
           [](View& view) {
             view.settings.physical.pulse.shape = Shape::tone;
             view.settings.physical.pulse.range_cell_m = 128 / 723380.0 * 1500 / 2;
           }},
      {.name = "elevation_pattern",
       .view =
           [] {
             View view = configured_view("demo.yaml", 20);
             view.settings.physical.speckle.kind =
                 render::SpeckleSettings::Kind::off;  // speckle would hide the fading
             return view;
           },
       .caption_before = "elevation_pattern: top_hat",
       .before = [](View& view) { view.settings.aperture.elevation = Elevation::top_hat; },
       .caption_after = "elevation_pattern: sinc",
       .after = [](View& view) { view.settings.aperture.elevation = Elevation::sinc; }},
  };
}

}  // namespace sonard::pictures
