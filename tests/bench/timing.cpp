// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/timing.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace sonard::bench {

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::vector<double> Timing::sorted() const {
  std::vector<double> result = durations_;
  std::sort(result.begin(), result.end());
  return result;
}

double Timing::median() const {
  if (durations_.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const std::vector<double> all = sorted();
  return (all[(all.size() - 1) / 2] + all[all.size() / 2]) / 2;
}

double Timing::quantile(double share) const {
  if (durations_.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const std::vector<double> all = sorted();
  const auto within = static_cast<std::size_t>(std::ceil(share * static_cast<double>(all.size())));
  return all[std::max<std::size_t>(within, 1) - 1];
}

double Timing::min() const {
  return durations_.empty() ? std::numeric_limits<double>::quiet_NaN()
                            : *std::min_element(durations_.begin(), durations_.end());
}

}  // namespace sonard::bench
