// SPDX-License-Identifier: Apache-2.0
// The sums of beams: patches in, lines out. Inline, so that its loops are vectorised in each file that
// includes it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "renderer/binning/binning.hpp"
#include "renderer/binning/cone_bearing.hpp"
#include "renderer/binning/echo_patch.hpp"
#include "renderer/binning/range_profile.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Accumulators of one beam; each thread reuses one object.
class BeamSums {
 public:
  /// @param solid_angle of the beam, steradians
  /// @param most_echo upper bound of the total echo that will be added
  void reset(const RangeBins& range, double solid_angle, double most_echo, const BinningOptions& options) {
    lines_per_m_ = 1.0 / range.step_m;
    solid_angle_ = static_cast<float>(solid_angle);
    least_weight_ = static_cast<float>(solid_angle) * (options.footprint ? full_share : full_share_of_points);
    mean_ = options.mean;
    weighs_ = options.mean || options.open_water;
    const auto lines = static_cast<std::size_t>(range.count);
    echo_.reset(lines, most_echo);
    weight_.reset(weighs_ ? lines : 0, solid_angle);
    samples = 0;
    invalid = 0;
  }

  void add(const EchoPatch& patch) {
    const auto lines_per_m = static_cast<float>(lines_per_m_);
    const double a = static_cast<double>(patch.range_a_m) * lines_per_m_;
    const double b = static_cast<double>(patch.range_b_m) * lines_per_m_;
    const float smear_a = patch.smear_a_m * lines_per_m, smear_b = patch.smear_b_m * lines_per_m;
    if (!std::isfinite(a + b +
                       static_cast<double>(smear_a + smear_b + patch.echo + patch.weight +
                                           patch.echo_gradient + patch.weight_gradient))) {
      ++invalid;
      return;
    }
    ++samples;
    echo_.add(a, smear_a, b, smear_b, patch.echo, patch.echo_gradient);
    if (weighs_) {
      weight_.add(a, smear_a, b, smear_b, patch.weight, patch.weight_gradient);
    }
  }

  void add_point(double line, float echo, float weight) {
    ++samples;
    echo_.add_point(line, echo);
    if (weighs_) {
      weight_.add_point(line, weight);
    }
  }

  void read(std::size_t lines, float* out) {
    echo_.finish();
    echo_.read(out);
    if (!weighs_) {
      return;
    }
    weight_.finish();
    weights_.resize(lines);
    weight_.read(weights_.data());
    if (!mean_) {
      return;
    }
    for (std::size_t k = 0; k < lines; ++k) {
      out[k] = std::min(1.0F, out[k] / std::max(weights_[k], least_weight_));
    }
  }

  /// Writes the open solid angle in the middle of every line, steradians; call it after read().
  void read_open(float* out) const {
    double open = static_cast<double>(solid_angle_);
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      const auto weight = static_cast<double>(weights_[k]);
      const double here = open - weight / 2;
      out[k] = here > least_open * static_cast<double>(solid_angle_) ? static_cast<float>(here) : 0.0F;
      open -= weight;
    }
  }

  std::uint64_t samples = 0;
  std::uint64_t invalid = 0;

 private:
  RangeProfile echo_, weight_;
  std::vector<float> weights_;
  double lines_per_m_ = 1.0;
  float solid_angle_ = 1.0F;
  float least_weight_ = 1.0F;  ///< divisor of smaller weights, steradians; > 0
  bool mean_ = false;
  bool weighs_ = false;  ///< weights are summed too
};

/// Resets the sums and adds all patches of a beam, in the thread that reads them afterwards.
/// @return false: the beam is empty, open water is not requested, and the sums are unchanged
using FillBeam = std::function<bool(std::size_t beam, BeamSums& sums)>;

/// Fills every beam, each in one job, and collects the sums. One thread owns a beam, so results do not depend
/// on the number of threads.
/// @param memory reused for BinningResult::echo, with any contents: saves allocating a megabyte per ping
BinningResult bin_beams(int beams, const RangeBins& range, const BinningOptions& options, WorkerPool& workers,
                        std::vector<float> memory, const FillBeam& fill);

/// Puts the patches of a beam into `patches`, which is empty. Runs on any thread.
using PatchesOfBeam = std::function<void(std::size_t beam, std::vector<EchoPatch>& patches)>;

/// Makes and sums the patches of each beam in one job, so that they are summed while they are in the cache.
/// @param memory see bin_beams()
BinningResult bin_patches(const Aperture& aperture, const RangeBins& range, const BinningOptions& options,
                          WorkerPool& workers, std::vector<float> memory, const PatchesOfBeam& patches_of);

/// Bins the patches in `columns`; beams are cones around the array of BinningOptions::cone_aperture.
BinningResult bin_by_cones(std::vector<PatchColumn> columns, const RangeBins& range,
                           const BinningOptions& options, WorkerPool& workers, std::vector<float> memory);

}  // namespace sonard::render
