// SPDX-License-Identifier: Apache-2.0
#include "tests/pictures/effects/effects.hpp"

namespace sonard::pictures {

std::vector<EffectPicture> water_pictures() {
  return {
      {.name = "absorption",
       .view = [] { return configured_view("demo.yaml", 40); },
       .caption_before = "no absorption, no TVG for it",
       .before =
           [](View& view) {
             view.settings.physical.absorption_db_per_m = 0;
             view.settings.physical.tvg.absorption_db_per_m = 0;
           },
       .caption_after = "sea water, TVG makes up for it",
       .after = [](View&) {}},
  };
}

}  // namespace sonard::pictures
