// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/bearings.hpp"

#include <cassert>
#include <cmath>

namespace sonard::gemini {

double bearing_rad(int beam, int beams) {
  assert(beam >= 0 && beam < beams);
  return std::asin((2.0 * beam + 1.0 - beams) / beams * sector_edge_sin);
}

std::vector<double> bearings_rad(int beams) {
  std::vector<double> bearings;
  bearings.reserve(static_cast<std::size_t>(beams));
  for (int beam = 0; beam < beams; ++beam) {
    bearings.push_back(bearing_rad(beam, beams));
  }
  return bearings;
}

std::vector<double> beam_edges_sin(int beams) {
  std::vector<double> edges;
  edges.reserve(static_cast<std::size_t>(beams) + 1);
  for (int edge = 0; edge <= beams; ++edge) {
    edges.push_back((2.0 * edge - beams) / beams * sector_edge_sin);
  }
  return edges;
}

}  // namespace sonard::gemini
