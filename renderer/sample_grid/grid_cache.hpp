// SPDX-License-Identifier: Apache-2.0
// The last grid that was made.
#pragma once

#include <optional>

#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// Grids cost more to make than a ping: the last one is kept for as long as the same aperture is asked for.
class GridCache {
 public:
  /// Makes the grid that the settings ask for.
  /// @param may_keep the cached grid may be used if it is equal.
  /// @return whether it was used; otherwise rebuild what was made of it.
  /// @throws RequestError as make_sample_grid()
  bool prepare(const SonarSettings& settings, bool may_keep);
  const SampleGrid& grid() const { return grid_; }
  /// Worked out when first asked for.
  const CellWeights& weights() {
    if (!weights_) {
      weights_.emplace(grid_);
    }
    return *weights_;
  }

 private:
  SampleGrid grid_;
  std::optional<CellWeights> weights_;
  std::optional<SonarSettings> made_of_;
};

}  // namespace sonard::render
