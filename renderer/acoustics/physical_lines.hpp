// Mode `physical` from the mean echo to samples: speckle, noise, envelope, gain (docs/physics.md 2.8, 2.9).
#pragma once

#include "renderer/acoustics/random.hpp"
#include "renderer/acoustics/receiver_tables.hpp"
#include "renderer/acoustics/speckle_field.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/sonar_renderer.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

struct PhysicalPing {
  const ReceiverTables& tables;
  SpeckleField& speckle;
  RandomKey speckle_key, noise_key;
  const SkipSwitches& skip;
};

/// @param echo mean echo, as the array hears it. @param skipped what was left out is added to it.
PingSamples receive_physical(const EchoImage& echo, const PhysicalPing& ping, const SonarSettings& settings,
                             WorkerPool& workers, SkipCounts& skipped);

}  // namespace sonard::render
