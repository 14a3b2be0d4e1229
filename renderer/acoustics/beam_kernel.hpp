// The receive pattern across neighbouring beams: what gives speckle and noise their grain.
#pragma once

#include <vector>

#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// Amplitude weights c_j, j = -half ... half, with sum c_j^2 = 1. A white field filtered with them is what a
/// tapered receive array of the aperture (LineArray), without element errors, makes of independent element
/// noise, and of many scatterers (docs/physics.md 2.8). {1} where beams are too far apart to share anything.
std::vector<float> receive_kernel(const Aperture& aperture);

}  // namespace sonard::render
