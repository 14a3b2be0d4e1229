// SPDX-License-Identifier: Apache-2.0
// The reference renderer for meshes: exact in elevation and range, adaptive quadrature in azimuth.
#pragma once

#include <vector>

#include "tests/oracle/echo_truth.hpp"
#include "tests/oracle/facets.hpp"

namespace sonard::oracle {

/// When to stop. Refinement ends when both bounds hold, or at the largest number of slices.
struct SliceOptions {
  double error_rms = 1e-4;         ///< of each beam; as RelativeError::rms
  double error_max = 2e-3;         ///< of each beam; as RelativeError::max
  int max_slices_per_beam = 8192;  ///< the error reached is reported either way
  int first_intervals = 16;        ///< of each beam, of half a degree; more of a wider one
  /// A beam is also divided at the azimuth of every corner of a facet, where its echo has kinks and jumps, if
  /// it holds no more corners than this. Then no facet can hide between two slices.
  int max_corners = 0;
  unsigned threads = 0;      ///< 0: one per core
  std::vector<int> beams{};  ///< only these are rendered, the others are 0; empty: all
};

/// Renders by slices. In each beam the azimuth is divided into intervals, each integrated by a Kronrod rule
/// of 7 slices whose distance from the Gauss rule of 3 of them is the interval's error; the worst interval
/// is halved until the bounds are met. The error of a bin is the sum over its intervals: for the bins of a
/// mesh, whose echo has kinks and jumps but no noise in azimuth, that is well above the error made (tests
/// hold it against closed forms).
/// The result is the same bits for any number of threads.
EchoTruth integrate_slices(const Facets& facets, const EchoLaw& law, const SliceOptions& options = {});

}  // namespace sonard::oracle
