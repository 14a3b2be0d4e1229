// SPDX-License-Identifier: Apache-2.0
// The six scenes of Cerqueira et al. 2017 (figures 7 and 8) as docs/gallery.md shows them.
#pragma once

#include <string>
#include <vector>

#include "tests/pictures/view.hpp"

namespace sonard::pictures {

struct GalleryScene {
  std::string name;    ///< of the file: docs/images/gallery/<name>.png
  std::string config;  ///< in configs/
  double range_m = 20.0;
  double time_s = 0.0;  ///< after the start of its trajectory
};

/// In the order of the paper.
const std::vector<GalleryScene>& gallery_scenes();

/// The view of a scene as its configuration has it.
View view_of(const GalleryScene& scene);

/// Geometry and sonar equation alone: smooth echoes in silent water, heard by a beam with sharp edges.
void take_effects_off(View& view);

}  // namespace sonard::pictures
