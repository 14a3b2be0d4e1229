// SPDX-License-Identifier: Apache-2.0
// Overlay of a picture: range rings, bearing lines, captions.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "renderer/picture/sector_geometry.hpp"

namespace sonard::picture {

/// Margin of a picture, for labels.
inline constexpr int grid_margin_px = 68;

/// Range rings with metres, and lines at these bearings with degrees: CV_8UC3 of geometry.size(), black if
/// not drawn. A bearing outside the sector is drawn at the nearer edge.
cv::Mat polar_grid(const SectorGeometry& geometry, const std::vector<int>& bearings_deg);

/// Draws the grid over `picture`, below brighter echoes, and `caption` in the top left corner.
void add_grid(cv::Mat& picture, const cv::Mat& grid, const std::string& caption);

/// Spacing of range rings for a full range: 1, 2 or 5 times a power of ten, for at most eight rings.
double ring_step_m(double range_m);

/// Round bearings for the lines of a sector, in degrees, -180..180: every 30 degrees in a wide sector, closer
/// in a narrow one.
std::vector<int> round_bearings_deg(const SectorGeometry& geometry);

}  // namespace sonard::picture
