// SPDX-License-Identifier: Apache-2.0
// The length of the pulse along the range: it spreads the mean echo and correlates speckle and noise of
// neighbouring lines.
#pragma once

#include <cstddef>
#include <vector>

#include "renderer/ping.hpp"
#include "renderer/sonar_settings.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Energy that a pulse brings, re the usual pulse: of a tone per line, behind the band of the transducer. 1:
/// the pulse has no length, or none for which levels are stated.
/// @param step_m RangeLines::step_m
double pulse_energy(const PhysicalModel& model, double step_m);

/// Response of a pulse, as PhysicalModel::Pulse has them, where an echo lies anywhere in its line: averaged
/// over the line, and over that in which it is received; a tone with rounded ends is sampled in the middle of
/// the latter (docs/physics.md 2.6). Chirps are followed out to 16 cells to either side; all shares of an
/// echo add up to the energy.
class PulseResponse {
 public:
  using Pulse = PhysicalModel::Pulse;

  /// A pulse that spreads nothing.
  PulseResponse() = default;
  /// @param cell_m PhysicalModel::range_cell_m; 0: spreads nothing
  /// @param tone_rounding_m PhysicalModel::tone_rounding_m
  /// @param energy what all shares add up to, pulse_energy()
  PulseResponse(Pulse pulse, double cell_m, double step_m, double tone_rounding_m = 0, double energy = 1);

  /// Shares of an echo in its own line and the lines to one side of it; 0: nothing is spread.
  int taps() const { return static_cast<int>(share_.size()); }
  /// Share of an echo that is received `lines` away from it.
  double share(int lines) const { return static_cast<double>(share_[static_cast<std::size_t>(lines)]); }

  /// Share of the energy that is received outside of the line of an echo.
  double share_outside() const { return share_.empty() ? 0.0 : 1 - share(0) / energy_; }

  /// What would be received beyond the ends of the image is left out. What `out` holds is used as memory.
  void apply(const EchoImage& echo, EchoImage& out, WorkerPool& workers) const;

 private:
  std::vector<float> share_;
  double energy_ = 1;
};

/// Lines shorter than the pulse hold echoes of the same scatterers, and noise behind the same matched filter:
/// their fields are a white one filtered with the amplitude of the pulse, sum of squares 1
/// (docs/physics.md 2.8).
class PulseCorrelation {
 public:
  /// Lines without correlation.
  PulseCorrelation() = default;
  /// Takes the main lobe of a chirp, and all of a tone.
  /// @param cell_m PhysicalModel::range_cell_m; 0: a pulse without length
  /// @param tone_rounding_m PhysicalModel::tone_rounding_m
  PulseCorrelation(PhysicalModel::Pulse pulse, double cell_m, double step_m, double tone_rounding_m = 0);

  /// Lines to either side that one line shares its field with; 0: none.
  int reach() const { return static_cast<int>(weights_.size()) - 1; }
  /// sum_j c_j rows[reach + j], j = -reach ... reach. @param rows 2 * reach + 1 of at least `width` numbers.
  void apply(const std::vector<const float*>& rows, int width, float* out) const;
  /// c_j of the sum, j >= 0; c_-j is the same.
  float weight(int lines) const { return weights_[static_cast<std::size_t>(lines)]; }

  bool operator==(const PulseCorrelation&) const = default;

 private:
  std::vector<float> weights_{1.0F};  ///< c_0 ... c_reach
};

}  // namespace sonard::render
