// SPDX-License-Identifier: Apache-2.0
// All that a sonar sees in one ping, before beams are formed.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "renderer/binning/echo_patch.hpp"

namespace sonard::render {

/// Patches by wedges of azimuth, from port to starboard. The wedges do not overlap.
struct SeenPatches {
  struct Wedge {
    double azimuth_rad = 0.0;  ///< of its middle, positive to port
    std::size_t end = 0;       ///< of its patches, which begin where those of the wedge before end
  };
  std::vector<Wedge> wedges;
  std::vector<EchoPatch> patches;

  std::span<const EchoPatch> of(std::size_t wedge) const {
    const std::size_t begin = wedge == 0 ? 0 : wedges[wedge - 1].end;
    return std::span(patches).subspan(begin, wedges[wedge].end - begin);
  }
};

}  // namespace sonard::render
