// The pulse across neighbouring range lines: what gives speckle and noise their grain along the range.
#pragma once

#include <cstddef>
#include <vector>

#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// Lines shorter than the pulse hear the same scatterers, and noise behind the same matched filter: their
/// fields are a white one filtered with the amplitude of the pulse, sum of squares 1 (docs/physics.md 2.8).
class RangeGrain {
 public:
  /// Lines share nothing.
  RangeGrain() = default;
  /// Of a chirp the main lobe, of a tone its share of each line. @param cell_m PhysicalModel::range_cell_m;
  /// 0: a pulse without length.
  RangeGrain(PhysicalModel::Pulse pulse, double cell_m, double step_m);

  /// Lines to either side that one line shares its field with; 0: none.
  int reach() const { return static_cast<int>(weights_.size()) - 1; }
  /// sum_j c_j rows[reach + j], j = -reach ... reach. @param rows 2 * reach + 1 of at least `width` numbers.
  void apply(const std::vector<const float*>& rows, int width, float* out) const;
  /// c_j of the sum, j >= 0; c_-j is the same.
  float weight(int lines) const { return weights_[static_cast<std::size_t>(lines)]; }

  bool operator==(const RangeGrain&) const = default;

 private:
  std::vector<float> weights_{1.0F};  ///< c_0 ... c_reach
};

}  // namespace sonard::render
