// SPDX-License-Identifier: Apache-2.0
// The reference renderer for meshes: exact in elevation and range, adaptive quadrature in azimuth.
#pragma once

#include <vector>

#include "tests/oracle/echo_truth.hpp"
#include "tests/oracle/facets.hpp"

namespace sonard::oracle {

/// Stopping rules. Refinement ends if both bounds hold, or at the largest number of slices.
struct SliceOptions {
  double error_rms = 1e-4;         ///< for each beam; as RelativeError::rms
  double error_max = 2e-3;         ///< for each beam; as RelativeError::max
  int max_slices_per_beam = 8192;  ///< in all cases, the error reached is reported
  int first_intervals = 16;        ///< per half degree of a beam
  /// A beam with at most this many corners of facets is also divided at each corner's azimuth, because its
  /// echo has kinks and jumps there. Then no facet can hide between two slices.
  int max_corners = 0;
  unsigned threads = 0;      ///< 0: one per core
  std::vector<int> beams{};  ///< only these are rendered, the others are 0; empty: all
};

/// Renders by slices. Each beam is divided into intervals of azimuth, each integrated by a Kronrod rule with
/// 7 slices. The error of an interval is its difference from the Gauss rule with 3 of these slices. The worst
/// interval is halved until the bounds hold. The error of a bin is the sum over its intervals. For meshes,
/// whose echo has kinks and jumps but no noise in azimuth, this estimate is well above the true error (tests
/// compare with closed forms). The result is identical to the bit for any number of threads.
EchoTruth integrate_slices(const Facets& facets, const EchoLaw& law, const SliceOptions& options = {});

}  // namespace sonard::oracle
