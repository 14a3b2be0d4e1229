// SPDX-License-Identifier: Apache-2.0
// Normals that shade segments, as arrays for vectorised loops.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/engines/cpu/vertex_normals.hpp"

namespace sonard::render {

/// The NormalRun of each segment, one array per number. Arrays never shrink, so they may be longer than the
/// number of segments.
struct NormalArrays {
  std::vector<float> at_h, at_s, at_z;  ///< NormalRun::at
  std::vector<float> h_per_x, s_per_x, z_per_x, h_per_t, s_per_t, z_per_t;

  /// @param original per segment: its index in `runs`
  void lay_out(const std::vector<NormalRun>& runs, const std::vector<std::uint32_t>& original);
};

}  // namespace sonard::render
