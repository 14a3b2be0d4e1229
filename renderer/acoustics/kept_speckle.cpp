// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/kept_speckle.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace sonard::render {

void KeptSpeckle::advance(const PingRequest& request, const ReceiverTables& tables) {
  using Kind = SpeckleSettings::Kind;
  const PhysicalModel& model = request.settings.physical;
  const Aperture& aperture = request.settings.aperture;
  const Maker maker{model.speckle.kind, request.seed, tables.filter, tables.pulse_correlation,
                    aperture.receive_beamwidth_rad};
  kept_ = model.speckle.kind == Kind::ou || model.speckle.kind == Kind::frozen;
  scans_ = aperture.beam_count() == 1;
  textured_ = model.speckle.texture_nu > 0;
  if (maker != maker_) {
    maker_ = maker;
    speckle_ = {SpeckleField(kept_ && !scans_ ? aperture.beam_count() : 0), {}};
    texture_ = speckle_;
    T_world_sonar_ = request.T_world_sonar;
  }
  const int lines = request.settings.range.count * tables.cells + 2 * tables.pulse_correlation.reach();
  const auto ensure = [&](Field& field) {
    if (!scans_) {
      field.fan.ensure_lines(lines);
    } else if (field.scanned.lines() < lines) {
      field.scanned = ScannedSpeckle(aperture.receive_beamwidth_rad, lines);
    }
  };
  if (kept_) {
    ensure(speckle_);
  }
  if (kept_ && textured_) {
    ensure(texture_);
  }
  if (model.speckle.kind == Kind::ou) {
    const double faded = decay(request);
    for (Field* field : {&speckle_, &texture_}) {
      field->fan.fade(faded);
      field->scanned.fade(faded);
    }
  }
  T_world_sonar_ = request.T_world_sonar;
  jitter_rad_ =
      model.bearing_jitter_rad *
      normal_number(make_random_key(request.seed, 0, RandomField::bearing_jitter, request.ping_number));
}

/// Squared motion since the last ping, in units of half the aperture and half a beamwidth. Turns of a
/// scanning head about its axis do not count: they change the bearing, and speckle is kept by bearing.
double KeptSpeckle::decay(const PingRequest& request) const {
  const Pose& now = request.T_world_sonar;
  const double moved = glm::length(now.position_m - T_world_sonar_.position_m) /
                       (request.settings.physical.speckle.aperture_m / 2);
  double half_angle_sine = 0;
  if (scans_) {
    half_angle_sine = glm::length(ScanPose(now).axis - ScanPose(T_world_sonar_).axis) / 2;
  } else {
    const glm::dquat turn = glm::conjugate(T_world_sonar_.orientation) * now.orientation;
    half_angle_sine = glm::length(glm::dvec3(turn.x, turn.y, turn.z));
  }
  const double turned =
      2 * std::asin(std::min(1.0, half_angle_sine)) / (request.settings.aperture.receive_beamwidth_rad / 2);
  return moved * moved + turned * turned;
}

RandomFieldOfPing KeptSpeckle::speckle(RandomKey key, const SkipSwitches& skip, SkipCounts& skipped) {
  return field_of(speckle_, key, skip, skipped);
}

RandomFieldOfPing KeptSpeckle::texture(RandomKey key, const SkipSwitches& skip, SkipCounts& skipped) {
  return textured_ ? field_of(texture_, key, skip, skipped) : RandomFieldOfPing{key};
}

RandomFieldOfPing KeptSpeckle::field_of(Field& field, RandomKey key, const SkipSwitches& skip,
                                        SkipCounts& skipped) {
  RandomFieldOfPing of_ping{key};
  if (kept_ && scans_) {
    of_ping.beam = field.scanned.at(ScanPose(T_world_sonar_).bearing_rad + jitter_rad_,
                                    maker_.pulse_correlation, key, skip, skipped);
  } else if (kept_) {
    of_ping.kept = &field.fan;
  }
  return of_ping;
}

}  // namespace sonard::render
