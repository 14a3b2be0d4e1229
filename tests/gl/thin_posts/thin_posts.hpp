// SPDX-License-Identifier: Apache-2.0
// Posts that are much thinner than a beam, moved by millimetres from ping to ping. A post is at full scale if
// its echo is that of the oracle, within the tolerance of the test.
#pragma once

#include <vector>

#include "tests/support/engine_test.hpp"

namespace sonard::test {

/// 2 m long.
struct ThinPost {
  double distance_m, width_m;
  int facets;       ///< around a round post; 0: a flat bar that faces the sonar
  double lean_rad;  ///< to port; a quarter of a turn: it lies across the axis
  double bed_m;     ///< depth of a bed below the sonar, on which the post's middle is 1 m high; 0: open water
};

/// 30 mm at 30 m and 2 mm at 15 m: an eighth and a sixtieth of a beam.
std::vector<ThinPost> thin_posts(int facets, double lean_rad, double bed_m);

/// Renders 16 pings of each post and prints the smallest and the largest echo, relative to the truth. From
/// ping to ping the post moves by 3.1 mm to port, across the border between two beams, and by 1.3 mm away. An
/// echo is the sum over all bins in which the post has an echo, less the echo of the bed alone.
/// @param tolerance of each echo, relative
void expect_full_scale(const std::vector<ThinPost>& posts, render::EngineKind engine,
                       render::Sampling::Preset preset, double tolerance);

}  // namespace sonard::test
