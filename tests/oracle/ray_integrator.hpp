// SPDX-License-Identifier: Apache-2.0
// The second reference renderer: rays on a spherical grid, footprints, refinement. For analytic shapes, and
// for comparison with the slices, which share only the echo law with it.
#pragma once

#include <vector>

#include "tests/oracle/echo_truth.hpp"
#include "tests/oracle/surface.hpp"

namespace sonard::oracle {

/// Sampling of a beam. The grid is doubled in both directions until the change is within both bounds, at most
/// `doublings` times. The last change is the reported error.
struct RayOptions {
  int columns = 4;  ///< first grid: cells per beam
  int rows = 512;   ///< first grid: cells over the height of the fan
  int doublings = 3;
  double error_rms = 1e-3;
  double error_max = 1e-2;
  /// How often a cell may be halved in both directions until its corners agree with its centre: the same
  /// plane within `range_tolerance` of a line, the same incidence within `cosine_tolerance`.
  int refinements = 3;
  double range_tolerance = 0.05;
  double cosine_tolerance = 0.01;
  /// false: a cell is a point in range. This converges slowly, but uses no formula that could be wrong.
  bool footprint = true;
  unsigned threads = 0;      ///< 0: one per core
  std::vector<int> beams{};  ///< only these are rendered, the others are 0; empty: all
};

/// Renders by rays. The result is identical to the bit for any number of threads.
EchoTruth integrate_rays(const Surface& surface, const EchoLaw& law, const RayOptions& options = {});

}  // namespace sonard::oracle
