// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/volume_reverberation.hpp"

#include <cmath>
#include <cstddef>

#include "renderer/acoustics/decibels.hpp"

namespace sonard::render {

bool has_volume_reverberation(const SonarSettings& settings) {
  return settings.model == Model::physical && settings.transmit &&
         decibels_to_power(settings.physical.volume_scattering_db) > 0;
}

void add_volume_reverberation(const std::vector<float>& open_sr, const SonarSettings& settings,
                              EchoImage& image) {
  const auto strength =
      static_cast<float>(decibels_to_power(settings.physical.volume_scattering_db) * settings.range.step_m);
  for (std::size_t i = 0; i < open_sr.size(); ++i) {
    image.intensity[i] += strength * open_sr[i];
  }
}

}  // namespace sonard::render
