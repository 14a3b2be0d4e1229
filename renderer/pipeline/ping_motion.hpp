// SPDX-License-Identifier: Apache-2.0
// Motion of the sonar between sending a ping and receiving its last echo.
#pragma once

#include <optional>
#include <vector>

#include "renderer/pose.hpp"

namespace sonard::render {

/// Where the sonar is while it pings.
struct SonarMotion {
  Pose T_world_sonar;          ///< when the ping is sent
  std::optional<Pose> at_end;  ///< when its last line is received; nullopt: as if at rest
  bool operator==(const SonarMotion&) const = default;
};

/// Range lines [first_line, end_line) of a ping, and the pose that stands for them: it is turned as in the
/// middle of the time at which they are received, and lies halfway between there and where the ping was sent,
/// so that ranges are half of the way out and back (docs/physics.md 2.14).
struct RangeSpan {
  int first_line = 0;
  int end_line = 0;
  Pose T_world_sonar;
};

/// Angle between the two orientations, in [0, pi].
double turn_between_rad(const Pose& a, const Pose& b);

/// Whether a turn during a ping matters: omega > (psi3 / 2) c / 2R, so that the receive beams have turned by
/// more than half of their -3 dB width psi3 when the last line is received.
inline bool turns_beams(double turn_rad, double receive_beamwidth_rad) {
  return turn_rad > receive_beamwidth_rad / 2;
}

/// Two to four spans of even length, as many as keep the turn within one below half of a receive beam if four
/// are enough. Velocity and turn rate are taken as even over the ping. Every line is in exactly one span.
/// @param at_transmission, at_end T_world_sonar when the ping leaves and when its last line is received
/// @param lines range bins, >= 1
std::vector<RangeSpan> range_spans(const Pose& at_transmission, const Pose& at_end, int lines,
                                   double receive_beamwidth_rad);

}  // namespace sonard::render
