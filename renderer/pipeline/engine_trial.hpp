// SPDX-License-Identifier: Apache-2.0
// Measures which engine is faster on this machine.
#pragma once

#include <span>
#include <string>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "renderer/renderer_options.hpp"

namespace sonard::render {

struct EngineTrial {
  EngineKind taken = EngineKind::cpu;
  /// Time for the mean echo of a ping: the mean over the pings in the fastest round. If the GPU takes longer
  /// for a sixteenth of the beams than the CPU for all, gpu_ms is for this sixteenth.
  double cpu_ms = 0.0, gpu_ms = 0.0;
  /// RMS of (the GPU's bin / the CPU's - 1) over bins above 1e-2 of their beam's maximum, without the worst
  /// hundredth; of the ping with the largest difference.
  double difference = 0.0;
  std::string cpu, gpu;     ///< engines and their hardware; `gpu` is empty if unavailable
  std::string gpu_problem;  ///< why the GPU is not used even if faster; empty: time decides
  std::string software_gl;  ///< set if OpenGL runs on the CPU, with its device; then nothing was timed
};

/// Renders these pings with both engines, for a quarter of a second plus a ping each, and selects the faster
/// one. The GPU is selected only if its bins agree with the CPU's within twice the error of each ping's
/// preset. The GPU first renders some beams of each ping, so that its shaders are built.
/// @throws RequestError, RendererError if the CPU cannot render them.
EngineTrial choose_engine(SonarRenderer& renderer, std::span<const HeadRequest> first_pings);

/// choose_engine() for a starting program. If OpenGL runs on the CPU, it selects the CPU engine without
/// rendering: such OpenGL is always slower, and to measure it would take seconds.
/// @throws RequestError, RendererError if the CPU cannot render them.
EngineTrial choose_engine_at_start(SonarRenderer& renderer, std::span<const HeadRequest> first_pings,
                                   const GpuOptions& gpu);

/// "cpu takes 14.2 ms a ping, gpu 410.0 ms (vendor / renderer / version): cpu is taken".
std::string describe(const EngineTrial& trial);

}  // namespace sonard::render
