// SPDX-License-Identifier: Apache-2.0
// Whether an engine draws what it should, and how fast.
#pragma once

#include <string>

#include "renderer/pipeline/engine_trial.hpp"
#include "renderer/renderer_options.hpp"

namespace sonard::render {

struct SelfTestResult {
  double error = 0.0;  ///< the larger RMS error over bins above 1e-2 of the largest of their beam
  std::string engine;  ///< what it ran on
};

/// Renders a wall with a closed-form echo and compares (docs/accuracy.md, T2), by the default preset and by a
/// fixed grid. Under `automatic` the engine is `cpu`.
/// @throws RendererError when the engine fails, the image is empty or the error exceeds 5 %.
SelfTestResult run_self_test(RendererOptions options = {});

/// choose_engine_at_start() on a fan of 256 beams and 1000 lines of 20 mm before that wall.
EngineTrial time_engines(const RendererOptions& options = {});

}  // namespace sonard::render
