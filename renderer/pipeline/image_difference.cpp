// SPDX-License-Identifier: Apache-2.0
#include "renderer/pipeline/image_difference.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

namespace sonard::render {

double bin_rms(const EchoImage& image, const EchoImage& truth, double kept_share) {
  constexpr float least_level = 1e-2F;  // of the largest bin of a beam
  std::vector<double> squares;
  for (int beam = 0; beam < truth.beams; ++beam) {
    float largest = 0.0F;
    for (int line = 0; line < truth.bins; ++line) {
      largest = std::max(largest, truth.at(beam, line));
    }
    for (int line = 0; line < truth.bins; ++line) {
      if (!std::isfinite(image.at(beam, line))) {
        return std::numeric_limits<double>::infinity();
      }
      if (truth.at(beam, line) > least_level * largest) {
        const double error = static_cast<double>(image.at(beam, line) / truth.at(beam, line)) - 1.0;
        squares.push_back(error * error);
      }
    }
  }
  if (squares.empty()) {
    return 0.0;
  }
  const auto kept = squares.begin() +
                    static_cast<std::ptrdiff_t>(std::ceil(kept_share * static_cast<double>(squares.size())));
  std::nth_element(squares.begin(), kept, squares.end());
  return std::sqrt(std::accumulate(squares.begin(), kept, 0.0) / static_cast<double>(kept - squares.begin()));
}

}  // namespace sonard::render
