// SPDX-License-Identifier: Apache-2.0
// Mode `physical` from the mean echo to samples: texture, speckle, noise, envelope, gain
// (docs/physics.md 2.8, 2.9).
#pragma once

#include "renderer/acoustics/correlated_field.hpp"
#include "renderer/acoustics/noise.hpp"
#include "renderer/acoustics/receiver_tables.hpp"
#include "renderer/ping.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Input of the receiver for one ping, beside its echo.
struct PhysicalReceiverInput {
  const ReceiverTables& tables;
  RandomFieldOfPing speckle, texture, noise;
  InterferenceBurst interference;
  float ring_down = 1.0F;     ///< factor of the ring-down's amplitude
  float noise_factor = 1.0F;  ///< of the noise's amplitude, at the bearing of this ping
  const SkipSwitches& skip;
};

/// Brings all lines of the kept fields up to date if lines share a pulse, because a line then needs its
/// neighbours. Otherwise each line is brought up to date when it is read.
void evolve_fields(const PhysicalReceiverInput& ping, WorkerPool& workers, SkipCounts& skipped);

/// @param echo mean echo, behind the array. @param skipped the work left out is added to it.
/// @param echo_over_floor gets PingStatistics::echo_over_floor
PingSamples receive_physical(const EchoImage& echo, const PhysicalReceiverInput& ping,
                             const SonarSettings& settings, WorkerPool& workers, SkipCounts& skipped,
                             double& echo_over_floor);

}  // namespace sonard::render
