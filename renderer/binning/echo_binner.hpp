// Surface samples -> echo per beam and range line.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/skip_ledger.hpp"
#include "renderer/sonar_settings.hpp"
#include "renderer/visibility/sample_grid.hpp"
#include "renderer/visibility/sampler.hpp"
#include "renderer/visibility/slices/slice_sampler.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

struct BinningOptions {
  bool mean = false;              ///< divide by the solid angle that fell into the line (mode `paper`)
  bool footprint = true;          ///< false: a sample is a point in range
  bool legacy_bin_index = false;  ///< docs/physics.md 1.2, A4; only with footprint = false
  bool open_water = false;        ///< fill BinningResult::open_sr; not with `mean`
  float largest_response = 1.0F;  ///< of any sample of a grid; sets how fine the sums are
  /// Beams are told apart by cones, and these are the beams (ConeBearings); null: by azimuth. With
  /// footprints.
  const Aperture* cone_aperture = nullptr;
  SkipSwitches skip{};  ///< for SkipRule::empty_beams, of slices
};

/// Means are not taken where less than this share of a beam is seen: there the weights are mostly rounding.
inline constexpr float least_share = 0x1p-32F;
/// A beam that is open to less than this share is blocked: what remains is the error of the solid angles.
inline constexpr double least_open = 2e-3;

struct BinningResult {
  int beams = 0;
  int lines = 0;
  /// [beam * lines + line]. Sum of response * solid angle * elevation pattern, steradians; with `mean` the
  /// weighted mean of response. Spreading and absorption are left to the caller: they depend on the line
  /// alone, and taken per line they stay exact where one sample spreads over many lines.
  std::vector<float> echo;
  /// [beam * lines + line], only where it was asked for. Solid angle * elevation pattern, steradians, of what
  /// of the beam nothing stands before, up to the middle of the line.
  std::vector<float> open_sr;
  std::uint64_t samples = 0;
  std::uint64_t invalid_samples = 0;
  std::uint64_t saturated_samples = 0;  ///< of GpuBinner: echoes beyond what its sums hold, taken as that
  SkipCounts skipped;
};

/// Sums of a fixed grid. `views` is what Sampler::sample() returned for `grid`. Sums are exact
/// (RangeProfile), so the result is the same for any number of threads.
/// @param memory for BinningResult::echo, whatever it holds: a megabyte need not be found anew for every
/// ping.
BinningResult bin_echoes(const SampleGrid& grid, const std::vector<const SurfaceSample*>& views,
                         const RangeLines& range, const BinningOptions& options, WorkerPool& workers,
                         std::vector<float> memory = {});

/// The same for slices, which always have footprints. `cells` run from port to starboard.
BinningResult bin_echoes(const std::vector<const SliceCell*>& cells, const Aperture& aperture,
                         const RangeLines& range, const BinningOptions& options, WorkerPool& workers,
                         std::vector<float> memory = {});

}  // namespace sonard::render
