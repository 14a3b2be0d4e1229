// SPDX-License-Identifier: Apache-2.0
// Where a scan pings, one angle after another. Source: docs/protocols/ping360.md 3.3.
#pragma once

namespace sonard::ping360 {

/// A sector runs clockwise from its start, across 0 if need be. More than half a turn is scanned one way, and
/// begun again at the start; less back and forth, without doubling the ends. The scan stares where start and
/// stop are one.
class Sweep {
 public:
  /// @param start, stop gradians, 0..399
  /// @param step gradians, > 0
  /// @param to_stop a sector that is scanned back and forth ends at `stop`, which a whole step may not reach
  Sweep(int start, int stop, int step, bool to_stop);

  int angle() const;  ///< gradians, 0..399
  /// It begins again at the start, and does not come back.
  bool one_way() const { return one_way_; }
  void advance();

 private:
  int start_;
  int step_;
  int span_;
  bool one_way_;
  int positions_;
  int position_ = 0;
  int direction_ = 1;
};

}  // namespace sonard::ping360
