// SPDX-License-Identifier: Apache-2.0
// Which method finds the visible surfaces, on how many threads a ping is made, and what may be skipped.
#pragma once

#include <string_view>

#include "renderer/skip_ledger.hpp"

namespace sonard::render {

enum class Backend {
  automatic,  ///< `raster` where OpenGL runs on hardware, `ray` where it is software or missing
  raster,     ///< OpenSceneGraph and OpenGL 4.5 through EGL
  ray,        ///< Embree on the CPU; never opens EGL
};

/// The name under the key `backend` of a configuration: "auto", "raster", "ray".
std::string_view name_of(Backend backend);

struct RendererOptions {
  Backend backend = Backend::automatic;
  unsigned threads = 0;  ///< that share the loops of one ping, the caller included; 0: one per core
  SkipSwitches skip{};   ///< all rules are on by default
  /// g / c: how much faster sound gets per metre upwards, over its speed at the sonar. Positive where rays
  /// sink, their radius of curvature is 1 / this; 0: rays are straight (docs/physics.md 2.12).
  double ray_curvature_per_m = 0.0;
};

}  // namespace sonard::render
