// SPDX-License-Identifier: Apache-2.0
#include "renderer/pipeline/echo_cache.hpp"

namespace sonard::render {

namespace {

/// Resets the values that only the receiver uses.
PaperModel echo_part(PaperModel model) {
  const PaperModel any;
  model.gain = any.gain;
  model.speckle = any.speckle;
  model.speckle_mean = any.speckle_mean;
  model.speckle_sd = any.speckle_sd;
  model.speckle_floor = any.speckle_floor;
  return model;
}

/// Compares the values that the receiver does not use.
bool same_echo(const PhysicalModel& a, const PhysicalModel& b) {
  return a.absorption_db_per_m == b.absorption_db_per_m && a.backscatter == b.backscatter &&
         a.pulse == b.pulse && a.volume_scattering_db == b.volume_scattering_db &&
         a.water_clutter == b.water_clutter && a.multipath == b.multipath;
}

/// Whether both settings give the same mean echo.
bool same_echo(const SonarSettings& a, const SonarSettings& b) {
  if (a.transmit != b.transmit || a.model != b.model || a.range.count != b.range.count ||
      a.range.step_m != b.range.step_m || a.sampling != b.sampling || a.aperture != b.aperture ||
      a.directions != b.directions) {
    return false;
  }
  return a.model == Model::physical ? same_echo(a.physical, b.physical)
                                    : echo_part(a.paper) == echo_part(b.paper);
}

/// Whether the echo depends on the seed of the ping: if elements have errors without their own seed.
bool has_random_array(const SonarSettings& settings) {
  const Aperture& aperture = settings.aperture;
  return has_array_beams(settings) && !aperture.element_seed &&
         (aperture.element_amplitude_sd > 0 || aperture.element_phase_sd_rad > 0);
}

}  // namespace

bool CachedEcho::fits(const PingRequest& wanted, const SonarMotion& motion_wanted,
                      std::uint64_t revision) const {
  return world_revision == revision && motion == motion_wanted && same_echo(settings, wanted.settings) &&
         (seed == wanted.seed || !has_random_array(wanted.settings));
}

void CachedEcho::keep_inputs(const PingRequest& request, const SonarMotion& motion_used,
                             std::uint64_t revision) {
  if (!same_echo(settings, request.settings)) {
    settings = request.settings;
  }
  seed = request.seed;
  motion = motion_used;
  world_revision = revision;
}

}  // namespace sonard::render
