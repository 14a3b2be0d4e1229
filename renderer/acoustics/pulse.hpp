// SPDX-License-Identifier: Apache-2.0
// The length of the pulse in range: it spreads the mean echo and correlates speckle and noise of neighbouring
// lines.
#pragma once

#include <cstddef>
#include <vector>

#include "renderer/physical_model.hpp"
#include "renderer/ping.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Energy of a pulse re the usual pulse; for a tone per line. It includes the loss in the transducer's band.
/// A pulse that is not a tone, without length, or without a usual pulse has only that loss.
/// @param step_m RangeBins::step_m
double pulse_energy(const PulseSettings& pulse, double step_m);

/// Mean response of a pulse of PulseSettings::Shape (docs/physics.md 2.6). The mean runs over all places
/// of the echo in its line, and over the line that receives it; a tone with rounded ends is sampled in the
/// middle of the receiving line. Chirps reach 16 cells to either side. All shares add up to the energy.
class PulseResponse {
 public:
  using Shape = PulseSettings::Shape;

  /// A pulse that spreads nothing.
  PulseResponse() = default;
  /// @param cell_m PulseSettings::range_cell_m; 0: spreads nothing
  /// @param tone_rounding_m PulseSettings::tone_rounding_m
  /// @param energy sum of all shares, pulse_energy()
  PulseResponse(Shape shape, double cell_m, double step_m, double tone_rounding_m = 0, double energy = 1);

  /// Number of shares: the echo's line and the lines to one side of it; 0 if nothing is spread.
  int taps() const { return static_cast<int>(share_.size()); }
  /// Share of an echo that is received `lines` away from it.
  double share(int lines) const { return static_cast<double>(share_[static_cast<std::size_t>(lines)]); }

  /// Share of the energy that is received outside the line of the echo.
  double share_outside() const { return share_.empty() ? 0.0 : 1 - share(0) / energy_; }

  /// Spreads an image; echoes beyond its ends are dropped. @param out its memory is reused
  void apply(const EchoImage& echo, EchoImage& out, WorkerPool& workers) const;

 private:
  std::vector<float> share_;
  double energy_ = 1;
};

/// Correlation of lines that are shorter than the pulse: they share scatterers, and noise behind one matched
/// filter. Their field is a white one filtered with the amplitude of the pulse, sum of squares 1
/// (docs/physics.md 2.8).
class PulseCorrelation {
 public:
  /// Lines without correlation.
  PulseCorrelation() = default;
  /// Uses the main lobe of a chirp, or the whole tone.
  /// @param cell_m PulseSettings::range_cell_m; 0: a pulse without length
  /// @param tone_rounding_m PulseSettings::tone_rounding_m
  PulseCorrelation(PulseSettings::Shape shape, double cell_m, double step_m, double tone_rounding_m = 0);

  /// Number of lines to either side with which a line is correlated.
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
