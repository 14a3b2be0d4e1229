// SPDX-License-Identifier: Apache-2.0
// The six scenes of Cerqueira et al. 2017 (figures 7 and 8), drawn for docs/gallery.md.
#pragma once

#include <string>
#include <vector>

#include "tests/pictures/view.hpp"

namespace sonard::pictures {

struct GalleryScene {
  std::string name;    ///< the file is docs/images/gallery/<name>.png
  std::string config;  ///< in configs/
  double range_m = 20.0;
  double time_s = 0.0;  ///< since the start of its trajectory
};

/// The scenes in the order of the paper.
const std::vector<GalleryScene>& gallery_scenes();

/// The view of a scene with its configuration.
View view_of(const GalleryScene& scene);

/// Switches effects off, except geometry and the sonar equation: smooth echoes, no noise, beams with sharp
/// edges.
void take_effects_off(View& view);

}  // namespace sonard::pictures
