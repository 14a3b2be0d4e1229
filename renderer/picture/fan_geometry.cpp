// SPDX-License-Identifier: Apache-2.0
#include "renderer/picture/fan_geometry.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <limits>
#include <utility>

namespace sonard::picture {
namespace {

double port_edge_rad(const std::vector<double>& bearings) {
  assert(bearings.size() >= 2);
  return bearings[0] - 0.5 * (bearings[1] - bearings[0]);
}

double starboard_edge_rad(const std::vector<double>& bearings) {
  return bearings.back() + 0.5 * (bearings.back() - bearings[bearings.size() - 2]);
}

}  // namespace

FanGeometry::FanGeometry(FanShape shape, int radius_px, int margin_px)
    : SectorGeometry(shape.range_m(), picture::port_edge_rad(shape.bearings_rad),
                     picture::starboard_edge_rad(shape.bearings_rad), radius_px, margin_px),
      shape_(std::move(shape)) {}

double FanGeometry::beam_at(double bearing_rad) const {
  if (bearing_rad < port_edge_rad() || bearing_rad > starboard_edge_rad()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto& bearings = shape_.bearings_rad;
  const auto above = std::upper_bound(bearings.begin() + 1, bearings.end() - 1, bearing_rad);
  const auto right = static_cast<std::size_t>(above - bearings.begin());
  const double left_rad = bearings[right - 1];
  return static_cast<double>(right - 1) + (bearing_rad - left_rad) / (bearings[right] - left_rad);
}

}  // namespace sonard::picture
