// SPDX-License-Identifier: Apache-2.0
// Bearings of the beams of a Gemini 720i (protocol/gemini/README.md 6.5).
#pragma once

#include <vector>

#include "protocol/gemini/messages.hpp"

namespace sonard::gemini {

/// Sine of half the nominal 120 degree sector. The beams are spaced evenly in the sine of the bearing.
inline constexpr double sector_edge_sin = 0.86602540378443864676;

/// Bearing of the centre of `beam` (0 = port-most) in radians, positive to starboard; -1.0405 for beam 0 of
/// 256. Requires 0 <= beam < beams.
double bearing_rad(int beam, int beams = beam_count);

/// bearing_rad of every beam, port to starboard.
std::vector<double> bearings_rad(int beams = beam_count);

/// Sines of the bearings of the `beams` + 1 beam edges, port to starboard, from -sin 60 to +sin 60 degrees.
std::vector<double> beam_edges_sin(int beams = beam_count);

}  // namespace sonard::gemini
