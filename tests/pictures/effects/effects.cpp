// SPDX-License-Identifier: Apache-2.0
#include "tests/pictures/effects/effects.hpp"

#include <utility>

namespace sonard::pictures {

std::vector<EffectPicture> effect_pictures() {
  std::vector<EffectPicture> all;
  for (const auto& family :
       {receiver_pictures, multipath_pictures, response_pictures, water_pictures, propagation_pictures}) {
    for (EffectPicture& picture : family()) {
      all.push_back(std::move(picture));
    }
  }
  return all;
}

}  // namespace sonard::pictures
