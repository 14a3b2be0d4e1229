// SPDX-License-Identifier: Apache-2.0
// Compensated summation (Neumaier 1974): the error of a sum does not grow with the number of terms.
#pragma once

#include <cmath>

namespace sonard::oracle {

class NeumaierSum {
 public:
  void add(double term) {
    const double next = sum_ + term;
    lost_ += std::abs(sum_) >= std::abs(term) ? (sum_ - next) + term : (term - next) + sum_;
    sum_ = next;
  }
  double value() const { return sum_ + lost_; }

 private:
  double sum_ = 0.0;
  double lost_ = 0.0;
};

}  // namespace sonard::oracle
