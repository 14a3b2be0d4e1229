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

/// Resets the values that only the receiver uses.
PhysicalModel echo_part(const PhysicalModel& model) {
  PhysicalModel part;
  part.absorption_db_per_m = model.absorption_db_per_m;
  part.backscatter = model.backscatter;
  part.multipath = model.multipath;
  part.pulse = model.pulse;
  part.range_cell_m = model.range_cell_m;
  part.tone_rounding_m = model.tone_rounding_m;
  part.usual_pulse = model.usual_pulse;
  part.band_loss_db = model.band_loss_db;
  part.water_clutter = model.water_clutter;
  part.volume_scattering_db = model.volume_scattering_db;
  return part;
}

/// Whether both settings give the same mean echo.
bool same_echo(const SonarSettings& a, const SonarSettings& b) {
  if (a.transmit != b.transmit || a.model != b.model || a.range.count != b.range.count ||
      a.range.step_m != b.range.step_m || a.sampling != b.sampling || a.aperture != b.aperture) {
    return false;
  }
  return a.model == Model::physical ? echo_part(a.physical) == echo_part(b.physical)
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

}  // namespace sonard::render
