// SPDX-License-Identifier: Apache-2.0
// Settings of echoes by way of smooth surfaces.
#pragma once

namespace sonard::render {

/// Echoes by way of smooth surfaces, in mode `physical` (docs/physics.md 2.11). If nothing in range is smooth
/// enough, SkipRule::multipath skips them.
struct MultipathSettings {
  enum class Level {
    off,      ///< nothing
    surface,  ///< ghosts in the water surface (World::water_surface_z_m)
    full,     ///< ghosts in every surface that mirrors, corner reflectors, bounces
  } level = Level::full;
  double bounce_loss_db = 3.0;      ///< per reflection, in addition to R and mu; >= 0
  int most_bounces = 0;             ///< surfaces on a path; below 2: no paths between rough surfaces
  double wavelength_m = 0.0020833;  ///< at the middle of the band; > 0
  /// Rms height of the water surface: 0 is a mirror, a light breeze about 0.02. In wind the surface gives no
  /// image.
  double water_surface_rms_height_m = 0.02;

  bool operator==(const MultipathSettings&) const = default;
};

}  // namespace sonard::render
