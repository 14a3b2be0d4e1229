#include "renderer/binning/echo_binner.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <utility>

#include "renderer/binning/cone_bearing.hpp"
#include "renderer/binning/grid_patches.hpp"
#include "renderer/binning/range_profile.hpp"

namespace sonard::render {

namespace {

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
                       static_cast<double>(smear_a + smear_b + patch.echo + patch.weight + patch.echo_tilt +
                                           patch.weight_tilt))) {
      ++invalid;
      return;
    }
    ++samples;
    echo_.add(a, smear_a, b, smear_b, patch.echo, patch.echo_tilt);
    if (weighs_) {
      weight_.add(a, smear_a, b, smear_b, patch.weight, patch.weight_tilt);
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

/// What a beam may hold at most.
struct BeamContent {
  double solid_angle;
  double echo;
};

/// Runs fill(beam, sums) for every beam that is not empty(beam), each in one job, and collects what it
/// summed. A beam has one owner, so nothing depends on the number of threads.
template <class Empty, class Content, class Fill>
BinningResult bin_beams(int beams, const RangeLines& range, const BinningOptions& options,
                        WorkerPool& workers, std::vector<float> memory, const Empty& empty,
                        const Content& content, const Fill& fill) {
  BinningResult result;
  result.echo = std::move(memory);
  result.beams = beams;
  result.lines = range.count;
  const auto lines = static_cast<std::size_t>(range.count);
  result.echo.resize(static_cast<std::size_t>(beams) * lines);
  result.open_sr.resize(options.open_water ? result.echo.size() : 0);
  std::atomic<std::uint64_t> samples{0};
  std::atomic<std::uint64_t> invalid{0};
  std::atomic<std::uint64_t> empty_beams{0};
  workers.run(beams, [&](int beam) {
    thread_local BeamSums sums;
    const auto b = static_cast<std::size_t>(beam);
    if (empty(b)) {
      ++empty_beams;
      std::fill_n(&result.echo[b * lines], lines, 0.0F);
      return;  // an empty beam is not asked for its open water
    }
    const BeamContent most = content(b);
    sums.reset(range, most.solid_angle, most.echo, options);
    fill(b, sums);
    sums.read(lines, &result.echo[b * lines]);
    if (options.open_water) {
      sums.read_open(&result.open_sr[b * lines]);
    }
    samples += sums.samples;
    invalid += sums.invalid;
  });
  result.samples = samples;
  result.invalid_samples = invalid;
  result.skipped.add(SkipRule::empty_beams, empty_beams);
  return result;
}

void add_points(const SampleGrid& grid, const std::vector<const SurfaceSample*>& views,
                const ColumnPart& part, double lines_per_m, BeamSums& sums) {
  const SubView& view = grid.views[static_cast<std::size_t>(part.view)];
  const SurfaceSample* column = views[static_cast<std::size_t>(part.view)] + part.column;
  for (int row = part.row_begin; row < part.row_end; ++row) {
    const SurfaceSample& sample = column[static_cast<std::ptrdiff_t>(row) * view.columns];
    const float weight = grid.weights[part.weights + static_cast<std::size_t>(row - part.row_begin)];
    if (sample.range_m > 0) {
      sums.add_point(std::floor(static_cast<double>(sample.range_m) * lines_per_m), weight * sample.response,
                     weight);
    }
    sums.invalid += sample.range_m < 0 ? 1 : 0;
  }
}

double solid_angle_of(const SampleGrid& grid, std::size_t beam) {
  const auto begin = static_cast<std::size_t>(grid.beam_parts[beam]);
  const auto end = static_cast<std::size_t>(grid.beam_parts[beam + 1]);
  const std::size_t first = begin < end ? grid.parts[begin].weights : 0;
  const std::size_t last = end < grid.parts.size() ? grid.parts[end].weights : grid.weights.size();
  return begin < end ? std::accumulate(grid.weights.begin() + static_cast<std::ptrdiff_t>(first),
                                       grid.weights.begin() + static_cast<std::ptrdiff_t>(last), 0.0)
                     : 0.0;
}

/// Memory of the thread for the one beam that it is at.
std::vector<EchoPatch>& patches_of_this_beam() {
  thread_local std::vector<EchoPatch> patches;
  return patches;
}

/// What lies in `columns`, told apart by cones.
BinningResult bin_by_cones(std::vector<PatchColumn> columns, const RangeLines& range,
                           const BinningOptions& options, WorkerPool& workers, std::vector<float> memory) {
  const Aperture& aperture = *options.cone_aperture;
  const ConeBearings bearings(aperture, std::move(columns));
  const double height =
      options.open_water ? aperture.pattern_height() : 2 * std::sin(aperture.elevation_limit_rad());
  return bin_beams(
      aperture.beam_count(), range, options, workers, std::move(memory), [](std::size_t) { return false; },
      [&](std::size_t beam) {
        std::vector<EchoPatch>& patches = patches_of_this_beam();
        bearings.patches_of(static_cast<int>(beam), patches);
        double echo = 0.0;
        for (const EchoPatch& patch : patches) {
          echo += std::isfinite(patch.echo) ? static_cast<double>(patch.echo) : 0.0;
        }
        return BeamContent{height * (aperture.beam_edges_rad[beam] - aperture.beam_edges_rad[beam + 1]),
                           echo};
      },
      [&](std::size_t, BeamSums& sums) {
        for (const EchoPatch& patch : patches_of_this_beam()) {
          sums.add(patch);
        }
      });
}

/// The part of a column, with its patches.
PatchColumn column_of(const SampleGrid& grid, const ColumnPart& part, const std::vector<EchoPatch>& patches) {
  const SubView& view = grid.views[static_cast<std::size_t>(part.view)];
  const double middle =
      -view.tan_half_width + (part.column + 0.5) * view.pixel_width() + static_cast<double>(part.x_offset);
  const double half = static_cast<double>(part.width) / 2;
  return {view.azimuth_rad - std::atan(middle - half), view.azimuth_rad - std::atan(middle + half),
          patches.data(), patches.data() + patches.size()};
}

BinningResult bin_grid_by_cones(const SampleGrid& grid, const std::vector<const SurfaceSample*>& views,
                                const RangeLines& range, const BinningOptions& options, WorkerPool& workers,
                                std::vector<float> memory) {
  std::vector<std::vector<EchoPatch>> patches(grid.parts.size());
  std::atomic<std::uint64_t> invalid{0};
  workers.run(static_cast<int>(grid.parts.size()), [&](int p) {
    const auto part = static_cast<std::size_t>(p);
    invalid += make_grid_patches(grid, views, grid.parts[part], patches[part]);
  });
  std::vector<PatchColumn> columns;
  for (std::size_t part = 0; part < grid.parts.size(); ++part) {
    columns.push_back(column_of(grid, grid.parts[part], patches[part]));
  }
  BinningResult result = bin_by_cones(std::move(columns), range, options, workers, std::move(memory));
  result.invalid_samples += invalid;
  return result;
}

BinningResult bin_slices_by_cones(const std::vector<const SliceCell*>& cells, const RangeLines& range,
                                  const BinningOptions& options, WorkerPool& workers,
                                  std::vector<float> memory) {
  std::vector<PatchColumn> columns;
  for (const SliceCell* cell : cells) {
    const double half = static_cast<double>(cell->slice.width_rad) / 2;
    columns.push_back({cell->slice.azimuth_rad + half, cell->slice.azimuth_rad - half, cell->patches.data(),
                       cell->patches.data() + cell->patches.size()});
  }
  return bin_by_cones(std::move(columns), range, options, workers, std::move(memory));
}

}  // namespace

BinningResult bin_echoes(const SampleGrid& grid, const std::vector<const SurfaceSample*>& views,
                         const RangeLines& range, const BinningOptions& options, WorkerPool& workers,
                         std::vector<float> memory) {
  if (options.cone_aperture != nullptr) {
    return bin_grid_by_cones(grid, views, range, options, workers, std::move(memory));
  }
  const double legacy_scale = options.legacy_bin_index ? (range.count - 1.0) / range.count : 1.0;
  const auto fill = [&](std::size_t beam, BeamSums& sums) {
    for (int p = grid.beam_parts[beam]; p < grid.beam_parts[beam + 1]; ++p) {
      const ColumnPart& part = grid.parts[static_cast<std::size_t>(p)];
      if (options.footprint) {
        thread_local std::vector<EchoPatch> patches;
        sums.invalid += make_grid_patches(grid, views, part, patches);
        for (const EchoPatch& patch : patches) {
          sums.add(patch);
        }
      } else {
        add_points(grid, views, part, legacy_scale / range.step_m, sums);
      }
    }
  };
  return bin_beams(
      grid.beam_count(), range, options, workers, std::move(memory), [](std::size_t) { return false; },
      [&](std::size_t beam) {
        const double solid_angle = solid_angle_of(grid, beam);
        return BeamContent{solid_angle, solid_angle * static_cast<double>(options.largest_response)};
      },
      fill);
}

BinningResult bin_echoes(const std::vector<const SliceCell*>& cells, const Aperture& aperture,
                         const RangeLines& range, const BinningOptions& options, WorkerPool& workers,
                         std::vector<float> memory) {
  if (options.cone_aperture != nullptr) {
    return bin_slices_by_cones(cells, range, options, workers, std::move(memory));
  }
  const int beams = aperture.beam_count();
  std::vector<std::size_t> begins(static_cast<std::size_t>(beams) + 1, cells.size());
  for (std::size_t i = cells.size(); i-- > 0;) {
    begins[static_cast<std::size_t>(cells[i]->beam)] = i;
  }
  const auto fill = [&](std::size_t beam, BeamSums& sums) {
    for (std::size_t i = begins[beam]; i < begins[beam + 1]; ++i) {
      for (const EchoPatch& patch : cells[i]->patches) {
        sums.add(patch);
      }
    }
  };
  // The bound of a mean's weights, or exactly what the beam sees.
  const double height =
      options.open_water ? aperture.pattern_height() : 2 * std::sin(aperture.elevation_limit_rad());
  // What the slices of a beam hold in fact: the echo of a bed at grazing incidence keeps its digits.
  const auto content = [&](std::size_t beam) {
    double echo = 0.0;
    for (std::size_t i = begins[beam]; i < begins[beam + 1]; ++i) {
      for (const EchoPatch& patch : cells[i]->patches) {
        echo += std::isfinite(patch.echo) ? static_cast<double>(patch.echo) : 0.0;
      }
    }
    return BeamContent{height * (aperture.beam_edges_rad[beam] - aperture.beam_edges_rad[beam + 1]), echo};
  };
  const auto empty = [&](std::size_t beam) {
    return options.skip.on(SkipRule::empty_beams) && !options.open_water &&
           std::all_of(cells.begin() + static_cast<std::ptrdiff_t>(begins[beam]),
                       cells.begin() + static_cast<std::ptrdiff_t>(begins[beam + 1]),
                       [](const SliceCell* cell) { return cell->patches.empty(); });
  };
  return bin_beams(beams, range, options, workers, std::move(memory), empty, content, fill);
}

}  // namespace sonard::render
