#include "tests/pictures/effects/effects.hpp"

namespace sonard::pictures {

std::vector<EffectPicture> response_pictures() {
  using Elevation = render::Aperture::Elevation;
  using Backscatter = render::PhysicalModel::Backscatter;
  return {
      {.name = "facets",
       .view = [] { return configured_view("demo-micron.yaml", 12); },
       .caption_before = "backscatter: lambert",
       .before = [](View& view) { view.settings.physical.backscatter = Backscatter::lambert; },
       .caption_after = "backscatter: lambert_facet",
       .after = [](View& view) { view.settings.physical.backscatter = Backscatter::lambert_facet; }},
      {.name = "elevation_pattern",
       .view = [] { return configured_view("demo.yaml", 20); },
       .caption_before = "elevation_pattern: top_hat",
       .before = [](View& view) { view.settings.aperture.elevation = Elevation::top_hat; },
       .caption_after = "elevation_pattern: sinc",
       .after = [](View& view) { view.settings.aperture.elevation = Elevation::sinc; }},
  };
}

}  // namespace sonard::pictures
