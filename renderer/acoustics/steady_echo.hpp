// SPDX-License-Identifier: Apache-2.0
// What single points send back: echoes that speckle does not touch (docs/physics.md 2.8).
#pragma once

#include <vector>

#include "renderer/acoustics/beam_pattern.hpp"
#include "renderer/acoustics/pulse.hpp"
#include "renderer/ping.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// A spot of the fine echo, three fine beams by three lines, that outshines all that array and pulse would
/// mix it with: the glint of a ball, a corner, a fish. It is one scatterer and not many with random phases,
/// so its amplitude is steady.
struct PointEcho {
  int fine_beam = 0;  ///< of the middle
  int line = 0;
  float share = 0;  ///< of the spot's intensity that is steady, (0, 1]: 1 where nothing else is near
};

/// How far array and pulse mix an echo with others, in fine beams and in lines.
struct MixingReach {
  int fine_beams = 1;
  int lines = 1;
};

/// Reach of an array's main lobe and of a pulse. @param settings of the head, not those with fine beams
MixingReach mixing_reach(const SonarSettings& settings);

/// The strongest points, 256 at most. @param faintest intensity of a cell that is looked at
std::vector<PointEcho> find_points(const EchoImage& fine, const MixingReach& reach, float faintest,
                                   WorkerPool& workers);

/// What beams receive of these points, inside their main lobes. @param pulse nullptr: a pulse without length
SteadyEcho receive_points(const std::vector<PointEcho>& points, const EchoImage& fine,
                          const BeamPattern& pattern, const PulseResponse* pulse, int beams);

}  // namespace sonard::render
