// SPDX-License-Identifier: Apache-2.0
// Correlation of two series of numbers.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace sonard::test {

/// Pearson's coefficient. @param b must be as long as `a`
inline double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double mean_a = 0, mean_b = 0, sum = 0, square_a = 0, square_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += a[i] / static_cast<double>(a.size());
    mean_b += b[i] / static_cast<double>(a.size());
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += (a[i] - mean_a) * (b[i] - mean_b);
    square_a += std::pow(a[i] - mean_a, 2);
    square_b += std::pow(b[i] - mean_b, 2);
  }
  return sum / std::sqrt(square_a * square_b);
}

}  // namespace sonard::test
