// SPDX-License-Identifier: Apache-2.0
// The bearing that a straight array measures: the angle of a cone around the array instead of the azimuth.
#pragma once

#include <cstddef>
#include <vector>

#include "renderer/aperture.hpp"
#include "renderer/binning/echo_patch.hpp"

namespace sonard::render {

/// Patches between two azimuths.
struct PatchColumn {
  double port_rad = 0.0, starboard_rad = 0.0;
  const EchoPatch* begin = nullptr;
  const EchoPatch* end = nullptr;
};

/// Sorts patches into beams by sin psi_c = sin psi cos theta (docs/physics.md 2.5). A patch is divided along
/// its elevations so finely that the bearing of each part varies by less than a quarter of a beam. Each part
/// is distributed over beams evenly over its azimuths, at its own mean range.
class ConeBearings {
 public:
  /// @param columns adjacent, in any order, within 90 degrees of the axis; their patches must outlive this
  /// object
  ConeBearings(const Aperture& aperture, std::vector<PatchColumn> columns);

  /// Replaces `patches` by the patches of one beam.
  void patches_of(int beam, std::vector<EchoPatch>& patches) const;

 private:
  std::vector<double> edges_sine_;  ///< of the beams
  std::vector<PatchColumn> columns_;
  std::vector<double> columns_port_sine_;
  double least_cosine_;  ///< of the elevations of the fan
};

}  // namespace sonard::render
