// SPDX-License-Identifier: Apache-2.0
// Echoes of single points, which have no speckle (docs/physics.md 2.8).
#pragma once

#include <vector>

#include "renderer/acoustics/beam_pattern.hpp"
#include "renderer/acoustics/pulse.hpp"
#include "renderer/ping.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// A spot of the fine echo, three fine beams by three lines, stronger than all echoes with which array and
/// pulse mix it: the glint of a ball, a corner, a fish. It is one scatterer instead of many with random
/// phases, so its amplitude is steady.
struct PointEcho {
  int fine_beam = 0;  ///< of the middle
  int line = 0;
  float share = 0;  ///< steady part of the spot's intensity, (0, 1]; 1 if nothing else is near
};

/// Distance over which array and pulse mix echoes, in fine beams and in lines.
struct MixingReach {
  int fine_beams = 1;
  int lines = 1;
};

/// Reach of an array's main lobe and of a pulse. @param settings of the head, not PointSpread::sampled()
MixingReach mixing_reach(const SonarSettings& settings);

/// The strongest points, at most 256. @param faintest cells of at most this intensity are ignored
std::vector<PointEcho> find_points(const EchoImage& fine, const MixingReach& reach, float faintest,
                                   WorkerPool& workers);

/// The echo of these points per beam, from main lobes and the side lobes beside them. @param pulse nullptr: a
/// pulse without length
SteadyEcho receive_points(const std::vector<PointEcho>& points, const EchoImage& fine,
                          const BeamPattern& pattern, const PulseResponse* pulse, int beams);

}  // namespace sonard::render
