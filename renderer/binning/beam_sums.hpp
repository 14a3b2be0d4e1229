// SPDX-License-Identifier: Apache-2.0
// The sums of beams: patches in, lines out. Its loops are part of what includes it, to be vectorised there.
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

/// One beam's accumulators, and the memory of one thread.
class BeamSums {
 public:
  /// @param solid_angle of the beam.
  /// @param most_echo that will be added.
  void reset(const RangeLines& range, double solid_angle, double most_echo, const BinningOptions& options) {
    lines_per_m_ = 1.0 / range.step_m;
    solid_angle_ = static_cast<float>(solid_angle);
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
      out[k] = weights_[k] > least_share * solid_angle_ ? std::min(1.0F, out[k] / weights_[k]) : 0.0F;
    }
  }

  /// What is still open in the middle of every line; after read().
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
  bool mean_ = false;
  bool weighs_ = false;  ///< the weights are summed too
};

/// Resets the sums and adds all that a beam receives, in the thread that will read them.
/// @return false: the beam is empty, has no open water, and the sums are as they were
using FillBeam = std::function<bool(std::size_t beam, BeamSums& sums)>;

/// Fills every beam, each in one job, and collects what it summed. A beam has one owner, so nothing depends
/// on the number of threads.
/// @param memory for BinningResult::echo, whatever it holds: saves allocating a megabyte for every
/// ping.
BinningResult bin_beams(int beams, const RangeLines& range, const BinningOptions& options,
                        WorkerPool& workers, std::vector<float> memory, const FillBeam& fill);

/// Puts what a beam receives into `patches`, which are empty. Any thread.
using PatchesOfBeam = std::function<void(std::size_t beam, std::vector<EchoPatch>& patches)>;

/// Each beam in one job from its patches to its lines: they are summed while they are in the cache.
/// @param memory as of bin_beams()
BinningResult bin_patches(const Aperture& aperture, const RangeLines& range, const BinningOptions& options,
                          WorkerPool& workers, std::vector<float> memory, const PatchesOfBeam& patches_of);

/// What lies in `columns`, told apart by cones around the array of BinningOptions::cone_aperture.
BinningResult bin_by_cones(std::vector<PatchColumn> columns, const RangeLines& range,
                           const BinningOptions& options, WorkerPool& workers, std::vector<float> memory);

}  // namespace sonard::render
