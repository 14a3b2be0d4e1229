// SPDX-License-Identifier: Apache-2.0
// Position of the transducer during long turns: to the centre or to a new sector.
#pragma once

#include "protocol/micron/frame.hpp"
#include "protocol/micron/units.hpp"

namespace sonard::micron {

class Motor {
 public:
  explicit Motor(int bearing) : from_(bearing) {}

  /// Starts a turn at constant speed the short way to `bearing`, from `begin` to `end`.
  void turn_to(int bearing, TimePoint begin, TimePoint end) {
    from_ = position(begin);
    way_ = shortest_turn(from_, bearing);
    begin_ = begin;
    end_ = end;
  }
  /// Jumps to `bearing`, for steps between lines, whose course is not visible from outside.
  void place(int bearing) {
    from_ = bearing;
    way_ = 0;
  }

  /// Bearing at `now`, 0..6399.
  int position(TimePoint now) const {
    if (now >= end_) {
      return wrapped(from_ + way_);
    }
    const double done = now <= begin_ ? 0.0
                                      : static_cast<double>((now - begin_).count()) /
                                            static_cast<double>((end_ - begin_).count());
    return wrapped(from_ + static_cast<int>(way_ * done));
  }
  bool turning(TimePoint now) const { return way_ != 0 && now < end_; }

 private:
  int from_;
  int way_ = 0;
  TimePoint begin_{};
  TimePoint end_{};
};

}  // namespace sonard::micron
