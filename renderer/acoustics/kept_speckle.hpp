// SPDX-License-Identifier: Apache-2.0
// The random fields that a sonar keeps from ping to ping.
#pragma once

#include <cstdint>

#include "renderer/acoustics/correlated_field.hpp"
#include "renderer/acoustics/receiver_tables.hpp"
#include "renderer/acoustics/scanned_speckle.hpp"
#include "renderer/acoustics/speckle_field.hpp"
#include "renderer/ping.hpp"
#include "renderer/pose.hpp"

namespace sonard::render {

/// Speckle and texture of one head. Kinds `ou` and `frozen` are kept: per line and beam for a fan, by
/// bearing for a single beam, because a scanning head returns to each bearing. Only one thread may call it.
class KeptSpeckle {
 public:
  /// Adapts the fields to the settings and the pose of a ping: draws them again if they no longer fit, fades
  /// `ou` by the motion since the last ping (docs/physics.md 2.8).
  void advance(const PingRequest& request, const ReceiverTables& tables);

  /// The fields that a ping reads; valid until the next call. @param skipped counts the work left out.
  RandomFieldOfPing speckle(RandomKey key, const SkipSwitches& skip, SkipCounts& skipped);
  RandomFieldOfPing texture(RandomKey key, const SkipSwitches& skip, SkipCounts& skipped);

 private:
  /// The settings that the fields were made for.
  struct Maker {
    SpeckleSettings::Kind kind = SpeckleSettings::Kind::off;
    std::uint64_t seed = 0;
    BeamFilter filter;
    PulseCorrelation pulse_correlation;
    double beamwidth_rad = 0;

    bool operator==(const Maker&) const = default;
  };
  struct Field {
    SpeckleField fan;
    ScannedSpeckle scanned;
  };

  double decay(const PingRequest& request) const;
  RandomFieldOfPing field_of(Field& field, RandomKey key, const SkipSwitches& skip, SkipCounts& skipped);

  Maker maker_;
  bool kept_ = false;
  bool scans_ = false;  ///< a single beam
  bool textured_ = false;
  Field speckle_, texture_;
  Pose T_world_sonar_;     ///< at the last ping
  double jitter_rad_ = 0;  ///< of the bearing of a single beam
};

}  // namespace sonard::render
