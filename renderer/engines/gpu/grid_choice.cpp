// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/grid_choice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "renderer/sample_grid/range_plane.hpp"

namespace sonard::render {

namespace {

constexpr double most_samples = 0x1p25;  // of a pass: half a GiB if all were kept
constexpr double most_beam_samples = 0x1p18;
constexpr int most_pixels = 8192;             // of a view in each direction; every OpenGL 4.5 can draw 16384
constexpr int most_columns = 512;             // of a beam, or of its zone
constexpr double narrowest_column = 0x1p-16;  // of a beam
constexpr int most_rows_factor = 16;

// Measured on the scenes of the benchmark (docs/accuracy.md). The error of bins falls with about the 0.6th
// power of the number of samples, and is hardly ever more than this share of the distance to the image of a
// quarter of the samples.
constexpr double bin_order = 0.6;
constexpr double error_of_distance = 0.4;
// The estimated error of a beam falls with the first power of the number of columns (or rows) where
// there is one edge, faster where there are many; and the beam is hardly ever off by more than twice that.
constexpr double beam_order = 4.0 / 3;
constexpr double beam_safety = 2;
constexpr double longest_stride = 8;  // in columns or rows; a coarser estimate may do better
constexpr double zone_stride = 32;
constexpr double widest_zone = 0.5;  // of what was sampled before; else all of it is sampled again
constexpr double zone_rest = 0.5;    // of a target, what lies outside of a zone may miss
constexpr int most_columns_beside = 64;
constexpr int thinnest_columns = 32;  // columns of a beam, to find what may be as thin

constexpr double least_level = 1e-2;  // of the beam's maximum; errors are taken over bins above it

/// At the coarsest: a row for every 0.16 degrees of elevation.
int least_rows(const Aperture& aperture) {
  constexpr double row_rad = std::numbers::pi / 9 / 128;
  return std::max(16, static_cast<int>(std::lround(2 * aperture.elevation_limit_rad() / row_rad)));
}

int most_rows(const Aperture& aperture) {
  int rows = least_rows(aperture);
  while (2 * rows <= std::min(most_pixels, most_rows_factor * least_rows(aperture))) {
    rows *= 2;
  }
  return rows;
}

BeamRun run_of(const Aperture& aperture, int begin, int end, const BeamDensity& density) {
  const double port_rad = aperture.beam_edges_rad[static_cast<std::size_t>(begin)];
  const double starboard_rad = aperture.beam_edges_rad[static_cast<std::size_t>(end)];
  BeamRun run{begin, end, {}, density.rows};
  if (density.has_zone()) {
    if (density.port_columns > 0) {
      run.views.push_back({port_rad, density.zone_port_rad, density.port_columns});
    }
    run.views.push_back({density.zone_port_rad, density.zone_starboard_rad, density.columns});
    if (density.starboard_columns > 0) {
      run.views.push_back({density.zone_starboard_rad, starboard_rad, density.starboard_columns});
    }
    return run;
  }
  const double width_rad = port_rad - starboard_rad;
  const int beams = end - begin;
  const int views = std::max(static_cast<int>(std::ceil(width_rad / widest_view_rad - 1e-9)),
                             (beams * density.columns + most_pixels - 1) / most_pixels);
  const int columns = (beams + views - 1) / views * density.columns;
  for (int i = 0; i < views; ++i) {
    run.views.push_back({port_rad - width_rad * i / views, port_rad - width_rad * (i + 1) / views, columns});
  }
  return run;
}

/// The power of two that is at least this and 1.
int power_of_two(double factor) {
  return 1 << static_cast<int>(std::ceil(std::log2(std::clamp(factor, 1.0, 0x1p20))));
}

/// How often the error is what it may be; 1: as large as it may be.
double miss(const BeamError& error, const BeamError& target) {
  return beam_safety * std::max(error.total / target.total, error.centroid_lines / target.centroid_lines);
}

double finer_factor(double miss) {
  return miss > 1 ? std::min(std::pow(miss, 1 / beam_order), longest_stride) : 1.0;
}

/// An even number of columns for a part of a beam that had so many.
int columns_beside(std::size_t had) {
  return std::min(most_columns_beside, static_cast<int>(had + had % 2));
}

/// Where edges are few and near to each other: more columns only there. Without a zone where they are not.
BeamDensity with_zone(const Aperture& aperture, int beam, const BeamState& state, const BeamError& target) {
  const std::vector<ColumnError>& columns = state.estimate.columns;
  // Trims both ends while what is left out stays small.
  std::size_t first = 0, last = columns.size();
  double rest = 0, within = 0;
  const auto square = [&](std::size_t i) { return std::pow(miss(columns[i].error, target), 2); };
  for (std::size_t i = 0; i < columns.size(); ++i) {
    within += square(i);
  }
  while (last - first > 1) {
    const double port = square(first), starboard = square(last - 1);
    if (rest + std::min(port, starboard) > zone_rest * zone_rest) {
      break;
    }
    rest += std::min(port, starboard);
    port < starboard ? ++first : --last;
  }
  within -= rest;
  BeamDensity zone{0, state.density.rows, columns[first].port_rad, columns[last - 1].starboard_rad, 0, 0};
  const auto b = static_cast<std::size_t>(beam);
  const double beam_rad = aperture.beam_edges_rad[b] - aperture.beam_edges_rad[b + 1];
  if (static_cast<double>(last - first) > widest_zone * static_cast<double>(columns.size()) ||
      beam_rad > widest_view_rad) {
    return {};
  }
  const double most_by_width = (zone.zone_port_rad - zone.zone_starboard_rad) / (narrowest_column * beam_rad);
  const double wanted = static_cast<double>(last - first) * std::min(std::sqrt(within), zone_stride);
  zone.columns = std::min({most_columns, power_of_two(wanted), power_of_two(most_by_width)});
  zone.port_columns = columns_beside(first);
  zone.starboard_columns = columns_beside(columns.size() - last);
  return zone.columns > static_cast<int>(last - first) ? zone : BeamDensity{};
}

/// Takes back what was gained over `now` until no more than `most` samples are left.
BeamDensity capped(BeamDensity wanted, const BeamDensity& now, double most) {
  while (wanted.samples() > most && (wanted.columns > now.columns || wanted.rows > now.rows)) {
    const bool more_columns = wanted.columns / now.columns >= wanted.rows / now.rows;
    (more_columns ? wanted.columns : wanted.rows) /= 2;
  }
  return wanted;
}

/// The density with which a beam is sampled next; unchanged where another pass is not needed or not possible.
class NextPass {
 public:
  NextPass(const Aperture& aperture, const std::vector<BeamState>& beams, const GridTargets& targets)
      : aperture_(aperture), targets_(targets) {
    for (const BeamState& beam : beams) {
      if (beam.estimate.thin && !beam.density.has_zone()) {
        least_columns_ = std::max(least_columns_, std::min(4 * beam.density.columns, thinnest_columns));
      }
    }
  }

  /// @param most samples that the beam may take.
  BeamDensity of(int beam, const BeamState& state, double most) const {
    const BeamDensity& now = state.density;
    const double by_columns = miss(state.estimate.by_columns, targets_.beam);
    const double by_rows = miss(state.estimate.by_rows, targets_.beam);
    const bool bins = state.bin_rms > targets_.bins;
    if (by_columns > 1 && by_rows <= 1 && !bins) {
      const BeamDensity zone = with_zone(aperture_, beam, state, targets_.beam);
      if (zone.has_zone() && zone.samples() <= most) {
        return zone;
      }
    }
    if (now.has_zone()) {
      return now;  // as well as it gets
    }
    const double both =
        bins ? std::min(std::pow(state.bin_rms / targets_.bins, 0.5 / bin_order), longest_stride) : 1.0;
    BeamDensity wanted = now;
    wanted.columns =
        std::max(now.columns * power_of_two(std::max(finer_factor(by_columns), both)), least_columns_);
    wanted.columns = std::max(now.columns, std::min(wanted.columns, most_columns));
    wanted.rows =
        std::min(now.rows * power_of_two(std::max(finer_factor(by_rows), both)), most_rows(aperture_));
    wanted.rows = std::max(now.rows, wanted.rows);
    return capped(wanted, now, most);
  }

 private:
  const Aperture& aperture_;
  const GridTargets& targets_;
  int least_columns_ = 0;
};

}  // namespace

GridTargets grid_targets(Sampling::Preset preset) {
  return preset == Sampling::Preset::fast ? GridTargets{0.05, {0.005, 0.25}}
                                          : GridTargets{0.01, {0.001, 0.05}};
}

BeamDensity first_density(const Aperture& aperture, Sampling::Preset preset) {
  check_aperture(aperture);
  const int rows = least_rows(aperture);
  BeamDensity density{4, 4 * rows, 0, 0, 0, 0};
  if (preset == Sampling::Preset::fast) {
    density = {2, 4 * rows, 0, 0, 0, 0};
  } else if (preset == Sampling::Preset::reference) {
    density = {32, most_rows(aperture), 0, 0, 0, 0};
  }
  const auto too_many = [&] { return whole_fan(aperture, density).samples() > most_samples; };
  while (too_many() && density.columns > 2) {
    density.columns /= 2;
    if (too_many() && density.rows > 2 * rows) {
      density.rows /= 2;
    }
  }
  return density;
}

BeamRun whole_fan(const Aperture& aperture, const BeamDensity& density) {
  return run_of(aperture, 0, aperture.beam_count(), density);
}

std::vector<BeamRun> beam_runs(const Aperture& aperture, const std::vector<BeamChoice>& choices) {
  std::vector<BeamRun> runs;
  for (std::size_t first = 0; first < choices.size();) {
    const BeamChoice& begin = choices[first];
    std::size_t alike = first + 1;
    while (alike < choices.size() && choices[alike].density == begin.density &&
           choices[alike].beam == choices[alike - 1].beam + 1) {
      ++alike;
    }
    int count = 1;
    while (2 * count <= static_cast<int>(alike - first) && 2 * count * begin.density.columns <= most_pixels) {
      count *= 2;
    }
    runs.push_back(run_of(aperture, begin.beam, begin.beam + count, begin.density));
    first += static_cast<std::size_t>(count);
  }
  return runs;
}

std::vector<BeamRun> thinned(std::vector<BeamRun> runs) {
  for (BeamRun& run : runs) {
    for (ViewSpan& view : run.views) {
      view.columns /= 2;
    }
    run.rows /= 2;
  }
  return runs;
}

ThinnedSamples::ThinnedSamples(const SampleGrid& fine, const std::vector<const SurfaceSample*>& samples,
                               const SampleGrid& coarse) {
  for (std::size_t v = 0; v < coarse.views.size(); ++v) {
    const SubView& from = fine.views[v];
    const SubView& to = coarse.views[v];
    std::vector<SurfaceSample> thinned;
    thinned.reserve(static_cast<std::size_t>(to.columns) * static_cast<std::size_t>(to.rows));
    const auto half_width = static_cast<float>(from.pixel_width() / 2);
    const auto half_height = static_cast<float>(from.pixel_height() / 2);
    for (int j = 0; j < to.rows; ++j) {
      const SurfaceSample* row = samples[v] + 2 * static_cast<std::ptrdiff_t>(j) * from.columns;
      const auto y = static_cast<float>(-from.tan_half_height + (2 * j + 0.5) * from.pixel_height());
      for (int i = 0; i < to.columns; ++i) {
        SurfaceSample sample = row[2 * static_cast<std::ptrdiff_t>(i)];
        if (sample.range_m > 0) {
          const auto x = static_cast<float>(-from.tan_half_width + (2 * i + 0.5) * from.pixel_width());
          RangePlane plane{sample.range_m, sample.range_dx, sample.range_dy};
          plane.move(x, y, half_width, half_height);
          sample = {plane.range, sample.response, plane.dx, plane.dy};
        }
        thinned.push_back(sample);
      }
    }
    views_.push_back(std::move(thinned));
  }
}

std::vector<const SurfaceSample*> ThinnedSamples::views() const {
  std::vector<const SurfaceSample*> views;
  for (const std::vector<SurfaceSample>& view : views_) {
    views.push_back(view.data());
  }
  return views;
}

double bin_error(const float* echo, const float* thinned, std::size_t lines,
                 const std::vector<float>& line_weight) {
  const auto weighted = [&](std::size_t k) {
    return echo[k] * (line_weight.empty() ? 1.0F : line_weight[k]);
  };
  float strongest = 0.0F;
  for (std::size_t k = 0; k < lines; ++k) {
    strongest = std::max(strongest, weighted(k));
  }
  double squares = 0;
  double bins = 0;
  for (std::size_t k = 0; k < lines; ++k) {
    if (weighted(k) > static_cast<float>(least_level) * strongest) {
      const auto off = static_cast<double>(thinned[k] / echo[k] - 1);
      squares += off * off;
      bins += 1;
    }
  }
  return bins > 0 ? error_of_distance * std::sqrt(squares / bins) : 0.0;
}

std::vector<BeamChoice> beams_to_refine(const Aperture& aperture, const std::vector<BeamState>& beams,
                                        const GridTargets& targets) {
  const NextPass next(aperture, beams, targets);
  std::vector<BeamChoice> choices;
  for (double most = most_beam_samples;; most /= 2) {
    choices.clear();
    double samples = 0;
    for (std::size_t b = 0; b < beams.size(); ++b) {
      const BeamDensity& now = beams[b].density;
      const BeamDensity density = next.of(static_cast<int>(b), beams[b], most);
      if (density != now) {
        choices.push_back({static_cast<int>(b), density});
        samples += density.samples();
      }
    }
    if (samples <= most_samples) {
      return choices;
    }
  }
}

}  // namespace sonard::render
