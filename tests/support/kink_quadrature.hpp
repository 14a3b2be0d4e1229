// SPDX-License-Identifier: Apache-2.0
// Integrals of functions that are smooth except for kinks at known places.
#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

namespace sonard::test {

/// Integral of `density`, smooth inside [from, to], by the midpoint rule. The variable is substituted by one
/// with zero slope at both ends, so that square roots that start or end there become smooth.
template <class Density>
double smooth_integral(const Density& density, double from, double to, int nodes = 32) {
  double sum = 0;
  for (int i = 0; i < nodes; ++i) {
    const double t = (i + 0.5) / nodes;
    const double share = t * t * t * (10 + t * (6 * t - 15));
    const double slope = 30 * t * t * (1 - t) * (1 - t);
    sum += density(from + (to - from) * share) * slope;
  }
  return sum * (to - from) / nodes;
}

/// Integral of `density` with kinks: splits at the kinks inside (from, to), and ignores other values and NaN.
template <class Density>
double kinked_integral(const Density& density, double from, double to, const std::vector<double>& kinks) {
  std::vector<double> edges{from, to};
  std::copy_if(kinks.begin(), kinks.end(), std::back_inserter(edges),
               [&](double kink) { return kink > from && kink < to; });
  std::sort(edges.begin(), edges.end());
  double sum = 0;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    sum += smooth_integral(density, edges[i], edges[i + 1]);
  }
  return sum;
}

}  // namespace sonard::test
