// SPDX-License-Identifier: Apache-2.0
// Motion of the sonar from the transmission of a ping to its last echo.
#pragma once

#include <optional>
#include <vector>

#include "renderer/pose.hpp"

namespace sonard::render {

/// Poses of the sonar during a ping.
struct SonarMotion {
  Pose T_world_sonar;          ///< at the transmit time
  std::optional<Pose> at_end;  ///< when the last line is received; nullopt: rendered as at rest
  bool operator==(const SonarMotion&) const = default;
};

/// Range lines [first_line, end_line) of a ping, and their pose. Its orientation is the one at the middle of
/// their reception. Its position is halfway between the position then and at transmission, so that ranges are
/// half of the way out and back (docs/physics.md 2.14).
struct RangeSpan {
  int first_line = 0;
  int end_line = 0;
  Pose T_world_sonar;
};

/// Angle between the two orientations, in [0, pi].
double turn_between_rad(const Pose& a, const Pose& b);

/// Whether a turn during a ping matters: omega > (psi3 / 2) c / 2R. The receive beams have then turned by
/// more than half of their -3 dB width psi3 when the last line is received.
inline bool turns_beams(double turn_rad, double receive_beamwidth_rad) {
  return turn_rad > receive_beamwidth_rad / 2;
}

/// Two to four spans of equal length: the fewest in which the turn is at most half of a receive beam, or
/// four. Assumes constant velocity and turn rate. Every line is in exactly one span.
/// @param at_transmission, at_end T_world_sonar at transmission and when the last line is received
/// @param lines range bins, >= 1
std::vector<RangeSpan> range_spans(const Pose& at_transmission, const Pose& at_end, int lines,
                                   double receive_beamwidth_rad);

}  // namespace sonard::render
