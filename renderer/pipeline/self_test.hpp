// SPDX-License-Identifier: Apache-2.0
// Tests an engine's images and measures its speed.
#pragma once

#include <string>

#include "renderer/pipeline/engine_trial.hpp"
#include "renderer/renderer_options.hpp"

namespace sonard::render {

struct SelfTestResult {
  double error = 0.0;  ///< the larger RMS error over bins above 1e-2 of their beam's maximum
  std::string engine;  ///< engine and hardware
};

/// Renders a wall with a closed-form echo and compares (docs/accuracy.md, T2), with the default preset and
/// with a fixed grid. `automatic` means `cpu`.
/// @throws RendererError if the engine fails, the image is empty or the error exceeds 5 %.
SelfTestResult run_self_test(RendererOptions options = {});

/// choose_engine_at_start() with a fan of 256 beams and 1000 lines of 20 mm in front of this wall.
EngineTrial time_engines(const RendererOptions& options = {});

}  // namespace sonard::render
