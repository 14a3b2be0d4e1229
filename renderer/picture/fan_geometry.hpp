// SPDX-License-Identifier: Apache-2.0
// The position of a range and a beam in a fan picture.
#pragma once

#include <vector>

#include "renderer/picture/sector_geometry.hpp"

namespace sonard::picture {

/// Bearings and ranges of the samples of a ping.
struct FanShape {
  std::vector<double> bearings_rad;  ///< centre of each beam, port (negative) to starboard, strictly rising
  int lines = 0;                     ///< > 0
  double line_step_m = 0.0;          ///< line i covers [i, i + 1) * line_step_m; > 0

  double range_m() const { return lines * line_step_m; }

  bool operator==(const FanShape&) const = default;
};

/// The fan seen from above. Its edges are half a beam beyond the centres of the first and the last beam.
class FanGeometry : public SectorGeometry {
 public:
  /// Requires at least two beams, bearings within +-90 degrees, radius_px > 0.
  FanGeometry(FanShape shape, int radius_px, int margin_px);

  const FanShape& shape() const { return shape_; }
  /// Fractional beam at a bearing: i at the centre of beam i, linear between centres and for half a beam
  /// beyond the outer ones; NaN outside.
  double beam_at(double bearing_rad) const;

 private:
  FanShape shape_;
};

}  // namespace sonard::picture
