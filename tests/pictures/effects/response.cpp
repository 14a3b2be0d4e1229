#include "tests/pictures/effects/effects.hpp"

namespace sonard::pictures {

std::vector<EffectPicture> response_pictures() {
  using Elevation = render::Aperture::Elevation;
  return {
      {.name = "elevation_pattern",
       .view = [] { return configured_view("demo.yaml", 20); },
       .caption_before = "elevation_pattern: tophat",
       .before = [](View& view) { view.settings.aperture.elevation = Elevation::top_hat; },
       .caption_after = "elevation_pattern: sinc",
       .after = [](View& view) { view.settings.aperture.elevation = Elevation::sinc; }},
  };
}

}  // namespace sonard::pictures
