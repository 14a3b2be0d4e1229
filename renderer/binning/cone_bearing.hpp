// SPDX-License-Identifier: Apache-2.0
// The bearing that a straight array measures: the angle of a cone around it, not the azimuth.
#pragma once

#include <cstddef>
#include <vector>

#include "renderer/binning/echo_patch.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// Patches of some azimuths.
struct PatchColumn {
  double port_rad = 0.0, starboard_rad = 0.0;
  const EchoPatch* begin = nullptr;
  const EchoPatch* end = nullptr;
};

/// Sorts what is seen into beams by sin psi_c = sin psi cos theta (docs/physics.md 2.5). A patch is divided
/// along its elevations, so finely that each part moves by less than a quarter of a beam, and each part is
/// shared among beams evenly over its azimuths, at its own mean range.
class ConeBearings {
 public:
  /// @param columns side by side in any order, within 90 degrees of the axis; they outlive this object
  ConeBearings(const Aperture& aperture, std::vector<PatchColumn> columns);

  /// Replaces `patches` by what beam `beam` receives.
  void patches_of(int beam, std::vector<EchoPatch>& patches) const;

 private:
  std::vector<double> edges_sine_;  ///< of the beams
  std::vector<PatchColumn> columns_;
  std::vector<double> columns_port_sine_;
  double least_cosine_;  ///< of the elevations of the fan
};

}  // namespace sonard::render
