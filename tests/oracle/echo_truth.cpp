// SPDX-License-Identifier: Apache-2.0
#include "tests/oracle/echo_truth.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sonard::oracle {

namespace {

/// Combines `deviation(i)` / truth.echo[i] over the bins of RelativeError.
template <class Deviation>
RelativeError pooled(const EchoTruth& truth, Deviation deviation) {
  RelativeError result;
  double squares = 0;
  std::size_t count = 0;
  const auto lines = static_cast<std::size_t>(truth.lines);
  for (std::size_t begin = 0; begin < truth.echo.size(); begin += lines) {
    const auto first = truth.echo.begin() + static_cast<std::ptrdiff_t>(begin);
    const double strongest = *std::max_element(first, first + truth.lines);
    for (std::size_t i = begin; i < begin + lines; ++i) {
      if (!(truth.echo[i] > 1e-4 * strongest)) {
        continue;
      }
      const double relative = deviation(i) / truth.echo[i];
      result.max = std::max(result.max, relative);
      if (truth.echo[i] > 1e-2 * strongest) {
        squares += relative * relative;
        ++count;
      }
    }
  }
  result.rms = count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0.0;
  return result;
}

}  // namespace

RelativeError estimated_error(const EchoTruth& truth) {
  return pooled(truth, [&](std::size_t i) { return truth.error[i]; });
}

RelativeError difference(const EchoTruth& a, const EchoTruth& b) {
  if (a.beams != b.beams || a.lines != b.lines) {
    throw std::invalid_argument("images of different size cannot be compared");
  }
  return pooled(b, [&](std::size_t i) { return std::abs(a.echo[i] - b.echo[i]); });
}

}  // namespace sonard::oracle
