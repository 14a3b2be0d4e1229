// SPDX-License-Identifier: Apache-2.0
// Which engine finds the visible surfaces, on how many threads a ping is made, and what may be skipped.
#pragma once

#include <cstdint>
#include <string_view>

#include "renderer/skip_ledger.hpp"

namespace sonard::render {

enum class EngineKind {
  automatic,  ///< `gpu` where OpenGL runs on hardware, `cpu` where it is software or missing
  gpu,        ///< OpenSceneGraph and OpenGL 4.5 through EGL
  cpu,        ///< azimuth slices on the CPU; never opens EGL
};

/// The name under the key `engine` of a configuration: "auto", "gpu", "cpu".
std::string_view name_of(EngineKind engine);

/// What engine `gpu` may do with the GPU.
struct GpuOptions {
  /// Video memory that meshes and normal maps may take, MiB, > 0.
  std::uint64_t memory_mib = 4096;
};

struct RendererOptions {
  EngineKind engine = EngineKind::automatic;
  unsigned threads = 0;  ///< that share the loops of one ping, the caller included; 0: one per core
  SkipSwitches skip{};   ///< all rules are on by default
  /// g / c: how much faster sound gets per metre upwards, over its speed at the sonar. Positive where rays
  /// sink, their radius of curvature is 1 / this; 0: rays are straight (docs/physics.md 2.12).
  double ray_curvature_per_m = 0.0;
  GpuOptions gpu{};
};

}  // namespace sonard::render
