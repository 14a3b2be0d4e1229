// SPDX-License-Identifier: Apache-2.0
// From mean echo to device samples: speckle, noise, gain, range compression, quantiser.
#pragma once

#include <map>

#include "renderer/acoustics/kept_speckle.hpp"
#include "renderer/acoustics/receiver_tables.hpp"
#include "renderer/ping.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// The receiver of all sonars that share a renderer; only one thread may call it. Mode `physical` with
/// speckle `ou` keeps a field per head, so that speckle persists over small motions, as in real water.
/// Everything else is a pure function of the request.
class Receiver {
 public:
  explicit Receiver(const SkipSwitches& skip = {}) : skip_(skip) {}

  /// Samples of one ping. @param echo mean echo intensity
  PingSamples receive(const EchoImage& echo, const PingRequest& request, int head, WorkerPool& workers);

  /// Advances the fields of a head as receive() does. @return false if receive() would advance only lines
  /// with an echo; the fields are then unchanged
  bool pass(const PingRequest& request, int head, WorkerPool& workers);

  /// Frees the memory of a head; its next ping is like its first one.
  void forget(int head) { heads_.erase(head); }

  /// Work that the last receive() left out.
  const SkipCounts& skipped() const { return skipped_; }
  /// PingStatistics::echo_over_floor of the last receive().
  double echo_over_floor() const { return echo_over_floor_; }

 private:
  struct HeadState {
    ReceiverTables tables;
    KeptSpeckle fields;
    ComplexRow white_noise{0}, noise{0};  ///< of a single beam
  };

  /// The state of a head, with tables for these settings.
  HeadState& state_of(const SonarSettings& settings, int head);
  /// Speckle and texture of a ping; valid until the next call of any function.
  RandomFieldOfPing speckle_of(HeadState& state, const PingRequest& request, int head);
  RandomFieldOfPing texture_of(HeadState& state, const PingRequest& request, int head);
  static RandomFieldOfPing noise_of(HeadState& state, RandomKey key);

  SkipSwitches skip_;
  SkipCounts skipped_;
  double echo_over_floor_ = 0.0;
  std::map<int, HeadState> heads_;
};

}  // namespace sonard::render
