// How finely backend `raster` samples for an error preset (docs/accuracy.md).
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "renderer/binning/echo_binner.hpp"
#include "renderer/sonar_settings.hpp"
#include "renderer/visibility/sample_grid.hpp"
#include "renderer/visibility/sampler.hpp"

namespace sonard::render {

/// The grids that one aperture may be sampled with, coarse to fine. A step doubles the columns or the rows in
/// turn, so that two steps down is the grid of every second column and row. Each is made when it is first
/// used.
class GridLadder {
 public:
  /// @throws RequestError when the aperture cannot be gridded.
  explicit GridLadder(const Aperture& aperture);

  /// True: made for this aperture.
  bool fits(const Aperture& aperture) const { return aperture_ == aperture; }

  const SampleGrid& grid(int step);
  Sampling sampling(int step) const;

  /// The finest: 32 columns a beam and 2048 rows over 20 degrees, or fewer where that were more than 2^25
  /// samples.
  int last_step() const { return last_step_; }
  /// Where a preset begins.
  int first_step(Sampling::Preset preset) const;

 private:
  static constexpr int step_count = 10;
  static constexpr int least_step = 2;

  Aperture aperture_;
  int views_ = 1;
  int last_step_ = least_step;
  std::array<std::unique_ptr<const SampleGrid>, step_count> grids_;
};

/// The error that `fast` and `normal` aim at: pooled relative RMS of bins above 1e-2 of their beam's maximum.
double target_error(Sampling::Preset preset);

/// Every second column and row of the samples of a grid, as if the grid two steps down had been sampled: each
/// is moved to the centre of its larger pixel, along the surface that it saw.
class ThinnedSamples {
 public:
  ThinnedSamples(const SampleGrid& fine, const std::vector<const SurfaceSample*>& samples,
                 const SampleGrid& coarse);
  /// As Sampler::sample() returns them; they live as long as this object.
  std::vector<const SurfaceSample*> views() const;

 private:
  std::vector<std::vector<SurfaceSample>> views_;
};

/// What the error of `image` may be, judged by how far the image of its thinned samples is from it.
/// @param line_weight of every line, what the image is yet to be multiplied with; empty: 1.
double estimate_error(const BinningResult& image, const BinningResult& thinned,
                      const std::vector<float>& line_weight);

/// The step to look with after `step` had this error. `step` itself: it is good enough, or none is finer.
int next_step(const GridLadder& ladder, int step, double error, double target);

}  // namespace sonard::render
