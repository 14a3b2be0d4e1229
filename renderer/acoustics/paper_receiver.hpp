// SPDX-License-Identifier: Apache-2.0
// Mode `paper` from the mean echo to samples: I * n, then gain with a clamp (docs/physics.md 1.1, 1.2 A8,
// A9).
#pragma once

#include "renderer/acoustics/random.hpp"
#include "renderer/ping.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

struct PaperReceiverInput {
  PaperModel model;
  RandomKey key;
  float codes = 0;  ///< per amplitude
  const SkipSwitches& skip;
};

/// @param skipped the work left out is added to it
PingSamples receive_paper(const EchoImage& echo, const PaperReceiverInput& ping,
                          const SonarSettings& settings, WorkerPool& workers, SkipCounts& skipped);

}  // namespace sonard::render
