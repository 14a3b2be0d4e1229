// SPDX-License-Identifier: Apache-2.0
// The last grid that was made.
#pragma once

#include <optional>

#include "renderer/aperture.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/sampling.hpp"

namespace sonard::render {

/// Keeps the last grid until another aperture or sampling is requested, because a grid costs more than a
/// ping.
class GridCache {
 public:
  /// Provides the grid of make_sample_grid().
  /// @param may_keep the cached grid may be used if it is equal
  /// @return true if the cached grid was used; false: rebuild everything that was made from it
  /// @throws RequestError see make_sample_grid()
  bool prepare(const Aperture& aperture, const Sampling& sampling, const GridOptions& options, bool may_keep);
  const SampleGrid& grid() const { return grid_; }
  /// Weights of the grid, computed on first use.
  const CellWeights& weights() {
    if (!weights_) {
      weights_.emplace(grid_);
    }
    return *weights_;
  }

 private:
  SampleGrid grid_;
  std::optional<CellWeights> weights_;
  struct Source {
    Aperture aperture;
    Sampling sampling;
    GridOptions options;
  };
  std::optional<Source> made_of_;
};

}  // namespace sonard::render
