// SPDX-License-Identifier: Apache-2.0
// Ranges that a slice expects at the two sides of its wedge if its surfaces continue as in its middle.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "renderer/engines/cpu/visible_arrays.hpp"
#include "renderer/engines/slices/first_slices.hpp"

namespace sonard::render {

inline constexpr int probe_padding = 4;  ///< at the end of a profile; number of probes written at once
/// 1 / horizontal distance at the probes of one side, 1 / m; 0 if nothing is seen.
using SideProfile = std::array<float, side_probes + probe_padding>;

/// Expectation of a slice at both sides of its wedge; neighbours compare theirs.
struct SliceSides {
  SideProfile port, starboard;
  // Shares of elevations, weighted by the elevation pattern (ProbeWeights).
  float ensonified = 0.0F;  ///< at which a surface is expected within the range
  float one_sided = 0.0F;   ///< at which only one side expects a surface
  float lines = 0.0F;       ///< range lines over which the expected ranges spread
};

/// The elevations and the range for the comparison of sides, for one ping.
struct SideView {
  SideView(const ProbeWeights& weight, float tan_limit, float bins_end_m, float line_m);

  float tan_limit;
  float bins_end_m;  ///< range of the end of the last bin
  float line_m;
  SideProfile secant;  ///< of the probes' elevations: range = secant / w
  const ProbeWeights& weight;
};

/// Computes SliceSides. One per thread; reuses its memory.
class SideExpectation {
 public:
  void find(const std::vector<VisibleSegment>& visible, float width_rad, const SideView& view,
            SliceSides& sides);

 private:
  void lay_out(const std::vector<VisibleSegment>& visible);
  void follow(float width_rad, float tan_limit);
  void find_probes(float tan_limit, float offset_rad);
  void profile(float tan_limit, float offset_rad, SideProfile& out);

  VisibleArrays seen_;
  std::vector<float> w_per_azimuth_;
  std::vector<std::int32_t> first_probe_, last_probe_;
};

}  // namespace sonard::render
