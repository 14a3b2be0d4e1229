// SPDX-License-Identifier: Apache-2.0
// Named sampling settings: the points in diagrams of error against time.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "renderer/sonar_settings.hpp"

namespace sonard::bench {

struct Point {
  std::string name;  ///< `preset` in the output
  /// Changes the settings of a scene to the settings of the point.
  std::function<void(render::SonarSettings&)> apply;
  /// False if the image is not echo energy, so that only its holes can be compared (mode `paper`).
  bool energy = true;
};

/// The presets for users: `fast`, `default`, `reference`.
std::vector<Point> preset_points();

/// The point of the default preset.
Point default_point();

/// A fixed grid of planar views, named grid_CxR: about C columns per beam, R rows over the fan.
Point grid_point(int columns_per_beam, int rows);

/// grid_point() without footprints, named point_CxR: each sample falls into one bin.
Point point_binning(int columns_per_beam, int rows);

/// The public code of Cerqueira et al. 2017 as described in docs/physics.md 1.2: one planar view with four
/// columns per beam and 512 rows, whole columns, no mask, no footprints, mean of sigmoids.
Point paper_point();

}  // namespace sonard::bench
