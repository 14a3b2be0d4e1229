// SPDX-License-Identifier: Apache-2.0
// The pictures of docs/acoustics.md: one view without and with each effect. Add an effect to the table of its
// family.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/pictures/view.hpp"

namespace sonard::pictures {

struct EffectPicture {
  std::string name;            ///< the file is docs/images/acoustics/<name>.png
  std::function<View()> view;  ///< of both halves
  std::string caption_before;
  std::function<void(View&)> before;  ///< changes the settings (or the world) for the left half
  std::string caption_after;
  std::function<void(View&)> after;  ///< changes the settings (or the world) for the right half
};

std::vector<EffectPicture> receiver_pictures();   ///< speckle, noise, samples without an echo
std::vector<EffectPicture> multipath_pictures();  ///< ghosts and corner reflectors
std::vector<EffectPicture> response_pictures();   ///< patterns of the aperture, pulse
std::vector<EffectPicture>
propagation_pictures();  ///< speed of sound, motion of the sonar during a ping, refraction
std::vector<EffectPicture> water_pictures();  ///< absorption and gain

/// All pictures, in this order.
std::vector<EffectPicture> effect_pictures();

}  // namespace sonard::pictures
