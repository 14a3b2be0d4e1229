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

/// The receiver of all sonars that share a renderer. One thread calls it. Mode `physical` with speckle `ou`
/// keeps a field per stream, so that speckle survives small motions as it does in the water; everything else
/// is a pure function of the request.
class Receiver {
 public:
  explicit Receiver(const SkipSwitches& skip = {}) : skip_(skip) {}

  /// @param echo mean echo intensity as EchoImage states it.
  PingSamples receive(const EchoImage& echo, const PingRequest& request, int stream, WorkerPool& workers);

  /// Leaves the fields of a stream as receive() would. @return false, and nothing has happened, when they
  /// would go on only where there is an echo.
  bool pass(const PingRequest& request, int stream, WorkerPool& workers);

  /// Gives the memory of a stream back; its next ping is as its first one.
  void forget(int stream) { streams_.erase(stream); }

  /// What the last receive() left out.
  const SkipCounts& skipped() const { return skipped_; }
  /// PingStatistics::echo_over_floor of the last receive().
  double echo_over_floor() const { return echo_over_floor_; }

 private:
  struct Stream {
    ReceiverTables tables;
    KeptSpeckle fields;
    ComplexRow white_noise{0}, noise{0};  ///< of a single beam
  };

  /// With tables for these settings.
  Stream& stream_for(const SonarSettings& settings, int stream);
  /// What the receiver makes of speckle and texture; good until the next call of anything.
  RandomFieldOfPing speckle_of(Stream& state, const PingRequest& request, int stream);
  RandomFieldOfPing texture_of(Stream& state, const PingRequest& request, int stream);
  static RandomFieldOfPing noise_of(Stream& state, RandomKey key);

  SkipSwitches skip_;
  SkipCounts skipped_;
  double echo_over_floor_ = 0.0;
  std::map<int, Stream> streams_;
};

}  // namespace sonard::render
