// SPDX-License-Identifier: Apache-2.0
// Which engine finds the visible surfaces, on how many threads a ping is made, and what may be skipped.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "renderer/skip_ledger.hpp"

namespace sonard::render {

enum class EngineKind {
  automatic,  ///< the faster of the two, once choose_engine() has measured them (engine_trial); before, `cpu`
  gpu,        ///< OpenSceneGraph and OpenGL 4.5 through EGL
  cpu,        ///< azimuth slices on the CPU; never opens EGL
};

/// The name under the key `engine` of a configuration: "auto", "gpu", "cpu".
std::string_view name_of(EngineKind engine);

/// What engine `gpu` runs on, and what it may take.
struct GpuOptions {
  /// A number in the list of `sonard selftest`, or a part of a name in it, in whatever case; empty: the best.
  std::string device;
  /// Video memory that meshes and normal maps may take, MiB, > 0.
  std::uint64_t memory_mib = 4096;
  /// Seconds after the loss of the GPU until it is tried again, > 0; 0: it is not.
  double retry_s = 0.0;
  /// For tests: the OpenGL context is destroyed in the middle of this image, counted from 1; 0: never.
  std::uint64_t lose_context_at_image = 0;
};

struct RendererOptions {
  EngineKind engine = EngineKind::automatic;
  unsigned threads = 0;  ///< that share the loops of one ping, the caller included; 0: one per core
  SkipSwitches skip{};   ///< all rules are on by default
  /// g / c: how much faster sound gets per metre upwards, over its speed at the sonar. Positive where rays
  /// sink, their radius of curvature is 1 / this; 0: rays are straight (docs/physics.md 2.12).
  double ray_curvature_per_m = 0.0;
  GpuOptions gpu{};
  /// Gets a line for the operator when the GPU is lost, or is back; called by the renderer's thread. May be
  /// empty.
  std::function<void(const std::string&)> report{};
};

}  // namespace sonard::render
