// SPDX-License-Identifier: Apache-2.0
// Named ways to sample a scene: the points of the run-time against error plane.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "renderer/sonar_settings.hpp"

namespace sonard::bench {

struct Point {
  std::string name;  ///< `preset` in the output
  /// Turns the settings of a scene into those of the point.
  std::function<void(render::SonarSettings&)> apply;
  /// False where the image is no echo energy and only its holes can be compared (mode `paper`).
  bool energy = true;
};

/// What a user sets: `fast`, `default`, `reference`, with the error each promises.
std::vector<Point> preset_points();

/// The one of them that is used when nothing is said.
Point default_point();

/// A fixed grid of planar views, named grid_CxR: about C columns a beam, R rows over the fan.
Point grid_point(int columns_per_beam, int rows);

/// The same without footprints, named point_CxR: each sample falls into one bin.
Point point_binning(int columns_per_beam, int rows);

/// The public code of Cerqueira et al. 2017 as docs/physics.md 1.2 reads it: one planar view of four columns
/// a beam and 512 rows, whole columns, no mask, no footprints, mean of sigmoids.
Point paper_point();

}  // namespace sonard::bench
