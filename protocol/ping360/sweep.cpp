// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping360/sweep.hpp"

#include <algorithm>

#include "protocol/ping360/units.hpp"

namespace sonard::ping360 {

Sweep::Sweep(int start, int stop, int step, bool to_stop)
    : start_(start),
      step_(step),
      span_(wrapped(stop - start)),
      one_way_(span_ > gradians_per_turn / 2),
      positions_(span_ / step + 1) {
  if (to_stop && !one_way_ && span_ % step != 0) {
    ++positions_;
  }
}

int Sweep::angle() const {
  return wrapped(start_ + std::min(position_ * step_, span_));
}

void Sweep::advance() {
  if (one_way_) {
    position_ = (position_ + 1) % positions_;
  } else if (positions_ > 1) {
    if (position_ == positions_ - 1) {
      direction_ = -1;
    } else if (position_ == 0) {
      direction_ = 1;
    }
    position_ += direction_;
  }
}

}  // namespace sonard::ping360
