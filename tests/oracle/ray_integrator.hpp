// SPDX-License-Identifier: Apache-2.0
// The second reference renderer: rays on a spherical grid, footprints, refinement. For analytic shapes, and
// to hold the slices against something that has no code in common with them but the echo law.
#pragma once

#include <vector>

#include "tests/oracle/echo_truth.hpp"
#include "tests/oracle/surface.hpp"

namespace sonard::oracle {

/// How finely a beam is sampled. The grid is doubled in both directions until the change is within both
/// bounds, at most `doublings` times; the last change is the error that is reported.
struct RayOptions {
  int columns = 4;  ///< first grid: cells per beam, over
  int rows = 512;   ///< the height of the fan
  int doublings = 3;
  double error_rms = 1e-3;
  double error_max = 1e-2;
  /// A cell is halved both ways, this often at the most, until its corners agree with its centre: the same
  /// plane within `range_tolerance` of a line, the same incidence within `cosine_tolerance`.
  int refinements = 3;
  double range_tolerance = 0.05;
  double cosine_tolerance = 0.01;
  /// false: a cell is a point in range. Slow to converge, but there is no formula in it that could be wrong.
  bool footprint = true;
  unsigned threads = 0;      ///< 0: one per core
  std::vector<int> beams{};  ///< only these are rendered, the others are 0; empty: all
};

/// The result is the same bits for any number of threads.
EchoTruth integrate_rays(const Surface& surface, const EchoLaw& law, const RayOptions& options = {});

}  // namespace sonard::oracle
