// SPDX-License-Identifier: Apache-2.0
// Angles of the pings of a scan. Source: protocol/ping360/README.md 3.3.
#pragma once

namespace sonard::ping360 {

/// A sector runs clockwise from its start, possibly across 0. A sector of more than half a turn is scanned
/// one way and then restarts; a smaller one back and forth, with one ping at each end. The scan stays at the
/// start if start and stop are equal.
class Sweep {
 public:
  /// @param start, stop gradians, 0..399
  /// @param step gradians, > 0
  /// @param to_stop end a back-and-forth scan at `stop`, even if whole steps do not reach it
  Sweep(int start, int stop, int step, bool to_stop);

  int angle() const;  ///< gradians, 0..399
  /// True if the scan restarts at the start instead of going back.
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
