// SPDX-License-Identifier: Apache-2.0
// Engine, threads and skip rules of a renderer.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "renderer/skip_ledger.hpp"

namespace sonard::render {

enum class EngineKind {
  automatic,  ///< the faster one, measured by choose_engine() (engine_trial); before that, `cpu`
  gpu,        ///< azimuth slices in compute shaders of OpenGL, through EGL
  cpu,        ///< azimuth slices on the CPU; never opens EGL
};

/// The value of the key `engine` in a configuration: "auto", "gpu", "cpu".
std::string_view name_of(EngineKind engine);

/// The GPU that engine `gpu` uses, and its limits.
struct GpuOptions {
  /// An index in the list of `sonard selftest`, or part of a name in it, in any case; empty: the best GPU.
  std::string device{};
  /// Limit of video memory for meshes and normal maps, MiB, > 0.
  std::uint64_t memory_mib = 4096;
  /// Seconds from the loss of the GPU to the next attempt, > 0; 0: no attempt.
  double retry_s = 0.0;
  /// For tests: destroys the OpenGL context in the middle of this image, counted from 1; 0: never.
  std::uint64_t lose_context_at_image = 0;
  /// For the benchmark: fills GpuCost::stages_ms, of one ping at a time.
  bool time_stages = false;
  /// For the benchmark: invocations of a group, each with a piece of the sweep; 0: as many as suit the
  /// device.
  int group = 0;
  /// For the benchmark: segments of a slice that are seen at a time; 0: as many as every OpenGL has room for.
  int segments = 0;
};

struct RendererOptions {
  EngineKind engine = EngineKind::automatic;
  unsigned threads = 0;  ///< for the loops of one ping, including the caller; 0: one per core
  SkipSwitches skip{};   ///< all rules are on by default
  /// g / c: the increase of sound speed per metre upwards, over the speed at the sonar, 1/m. If positive,
  /// rays sink. The radius of curvature is 1 / this; 0: rays are straight (docs/physics.md 2.12).
  double ray_curvature_per_m = 0.0;
  GpuOptions gpu{};
  /// Receives a line for the operator when the GPU is lost or back; called on the renderer's thread. May be
  /// empty.
  std::function<void(const std::string&)> report{};
};

}  // namespace sonard::render
