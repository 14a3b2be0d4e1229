// SPDX-License-Identifier: Apache-2.0
// Which engine is faster here, by measurement.
#pragma once

#include <span>
#include <string>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "renderer/renderer_options.hpp"

namespace sonard::render {

struct EngineTrial {
  EngineKind taken = EngineKind::cpu;
  /// For the mean echo of a ping, of the fastest round of all of them. Of a GPU that takes longer for a
  /// sixteenth of the beams than the CPU for all, what it takes for these.
  double cpu_ms = 0.0, gpu_ms = 0.0;
  /// RMS of (the GPU's bin / the CPU's - 1) over bins above 1e-2 of the largest of their beam, without the
  /// worst hundredth; of the ping where it is most.
  double difference = 0.0;
  std::string cpu, gpu;     ///< what they run on; `gpu` is empty when it cannot be had
  std::string gpu_problem;  ///< why it is not taken, whatever its time; empty: that decides
  std::string software_gl;  ///< set: OpenGL runs on the CPU, by this device, and nothing was timed
};

/// Renders these pings with both engines, for a quarter of a second and a ping each, and lets the renderer go
/// on with the faster one: the GPU only where its bins are those of the CPU within twice the error that the
/// preset of each ping promises. The GPU makes some beams of each before that, so that its shaders are built.
/// @throws RequestError, RendererError when the CPU cannot render them.
EngineTrial choose_engine(SonarRenderer& renderer, std::span<const StreamPing> first_pings);

/// The same for a program that starts, which does not wait for OpenGL that runs on the CPU: it is never
/// faster than the CPU engine, and takes seconds to say so. No ping is rendered then, and the CPU engine is
/// taken.
/// @throws RequestError, RendererError when the CPU cannot render them.
EngineTrial choose_engine_at_start(SonarRenderer& renderer, std::span<const StreamPing> first_pings,
                                   const GpuOptions& gpu);

/// "cpu takes 14.2 ms a ping, gpu 410.0 ms (vendor / renderer / version): cpu is taken".
std::string describe(const EngineTrial& trial);

}  // namespace sonard::render
