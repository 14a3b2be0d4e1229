// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/grid_choice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sonard::render {

namespace {

constexpr double most_samples = 0x1p25;  // of a pass; together they would take half a GiB
constexpr double most_beam_samples = 0x1p18;
constexpr int most_pixels = 8192;             // of a view in each direction; every OpenGL 4.5 supports 16384
constexpr int most_columns = 512;             // of a beam, or of its zone
constexpr double narrowest_column = 0x1p-16;  // of a beam
constexpr int first_rows_factor = 4;
constexpr int most_rows_factor = 16;

// Measured on the scenes of the benchmark (docs/accuracy.md). The error of bins falls with about the 0.6th
// power of the number of samples.
constexpr double bin_order = 0.6;
// The estimated error of a beam falls with the first power of the number of columns (or rows) if there is one
// edge, faster if there are many. The real error is rarely more than twice the estimate.
constexpr double beam_order = 4.0 / 3;
constexpr double beam_safety = 1.7;
constexpr double longest_stride = 8;      // largest factor of columns or rows before the last pass
constexpr double last_beam_order = 1.12;  // smaller, because no later pass corrects the density
constexpr double zone_stride = 32;
constexpr double widest_zone = 0.5;  // of the columns; otherwise the whole beam is sampled again
constexpr int most_columns_beside = 64;
constexpr double samples_of_a_view = 0x1p13;  // samples that cost as much time as another view
constexpr double worst_beam = 1.1;            // largest error of one beam's bins, re the target of all bins
constexpr int thinnest_columns = 32;          // columns of a beam that find equally thin objects

/// Smallest number of rows: one per 0.16 degrees of elevation.
int least_rows(const Aperture& aperture) {
  constexpr double row_rad = std::numbers::pi / 9 / 128;
  return std::max(16, static_cast<int>(std::lround(2 * aperture.elevation_limit_rad() / row_rad)));
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

/// The smallest of 1, 1.25, 1.5, 2, 2.5, 3, 4 ... that is at least `factor`: few sizes, so that neighbours
/// can share views.
double round_up(double factor) {
  const double power = std::exp2(std::floor(std::log2(std::clamp(factor, 1.0, 0x1p20))));
  for (const double step : {1.0, 1.25, 1.5}) {
    if (factor <= step * power) {
      return step * power;
    }
  }
  return 2 * power;
}

/// Numbers of columns and rows are even, so that every second one can be left out.
int round_up_to_even(double count) {
  return 2 * static_cast<int>(std::ceil(count / 2 - 1e-9));
}

/// The estimated error re the target.
double miss(float total, float centroid_lines, const BeamError& target) {
  return beam_safety * std::max(static_cast<double>(total) / target.total,
                                static_cast<double>(centroid_lines) / target.centroid_lines);
}

/// The estimated relative RMS error of a beam's bins.
double bin_rms(const BeamState& beam) {
  const BeamEstimate& estimate = beam.estimate;
  return estimate.bins > 0
             ? beam.error_of_distance * std::sqrt(static_cast<double>(estimate.bin_squares) / estimate.bins)
             : 0.0;
}

/// Limit of the RMS error per beam at which the RMS error of all bins meets the target: accurate beams allow
/// larger errors of others.
double most_bin_rms(const std::vector<BeamState>& beams, double target) {
  double low = target, high = worst_beam * target;
  for (int i = 0; i < 30; ++i) {
    const double most = std::sqrt(low * high);
    double squares = 0, bins = 0;
    for (const BeamState& beam : beams) {
      const double rms = std::min(bin_rms(beam), most);
      squares += rms * rms * beam.estimate.bins;
      bins += beam.estimate.bins;
    }
    (squares > target * target * bins ? high : low) = most;
  }
  return low;
}

double finer_factor(double miss, bool is_last) {
  if (!(miss > 1)) {
    return 1.0;
  }
  return is_last ? std::pow(miss, 1 / last_beam_order)
                 : std::min(std::pow(miss, 1 / beam_order), longest_stride);
}

/// Even number of columns for a part of a beam beside its zone. @param had columns in the last pass
int columns_beside(int had) {
  return std::min(most_columns_beside, had + had % 2);
}

/// More columns only in the zone, if edges are few and near to each other; otherwise a density without zone.
BeamDensity with_zone(const Aperture& aperture, int beam, const BeamState& state) {
  const BeamEstimate& estimate = state.estimate;
  BeamDensity zone{0, state.density.rows, state.zone_port_rad, state.zone_starboard_rad, 0, 0};
  const auto b = static_cast<std::size_t>(beam);
  const double beam_rad = aperture.beam_edges_rad[b] - aperture.beam_edges_rad[b + 1];
  const int columns = estimate.zone_end - estimate.zone_begin;
  if (columns > widest_zone * state.columns || beam_rad > widest_view_rad) {
    return {};
  }
  const double most_by_width = (zone.zone_port_rad - zone.zone_starboard_rad) / (narrowest_column * beam_rad);
  const double wanted = columns * std::min(static_cast<double>(estimate.zone_miss), zone_stride);
  zone.columns =
      std::min({most_columns, round_up_to_even(round_up(wanted)), round_up_to_even(round_up(most_by_width))});
  zone.port_columns = columns_beside(estimate.zone_begin);
  zone.starboard_columns = columns_beside(state.columns - estimate.zone_end);
  return zone.columns > columns ? zone : BeamDensity{};
}

/// Reduces `wanted` towards `now` until it has at most `most` samples.
BeamDensity capped(BeamDensity wanted, const BeamDensity& now, double most) {
  while (wanted.samples() > most && (wanted.columns > now.columns || wanted.rows > now.rows)) {
    const bool more_columns = 1.0 * wanted.columns / now.columns >= 1.0 * wanted.rows / now.rows;
    int& count = more_columns ? wanted.columns : wanted.rows;
    count = std::max(more_columns ? now.columns : now.rows, round_up_to_even(0.5 * count));
  }
  return wanted;
}

/// Lets neighbours share views if the additional samples cost less than another view.
void share_views(std::vector<BeamChoice>& choices) {
  for (std::size_t first = 0; first < choices.size();) {
    BeamDensity shared = choices[first].density;
    std::size_t end = first + 1;
    for (; end < choices.size() && !shared.has_zone(); ++end) {
      const BeamChoice& next = choices[end];
      BeamDensity both = shared;
      both.columns = std::max(shared.columns, next.density.columns);
      both.rows = std::max(shared.rows, next.density.rows);
      const auto count = static_cast<double>(end - first);
      const double more = (count + 1) * both.samples() - count * shared.samples() - next.density.samples();
      if (next.density.has_zone() || next.beam != choices[end - 1].beam + 1 || more > samples_of_a_view) {
        break;
      }
      shared = both;
    }
    for (; first < end; ++first) {
      choices[first].density = shared;
    }
  }
}

/// Computes the next density of a beam; it is unchanged if another pass is not needed or not possible.
class NextPass {
 public:
  NextPass(const Aperture& aperture, const std::vector<BeamState>& beams, const GridTargets& targets,
           bool is_last)
      : aperture_(aperture),
        targets_(targets),
        is_last_(is_last),
        most_bin_rms_(most_bin_rms(beams, targets.bins)) {
    for (const BeamState& beam : beams) {
      if (beam.estimate.thin > 0 && !beam.density.has_zone()) {
        least_columns_ = std::max(least_columns_, std::min(4 * beam.density.columns, thinnest_columns));
      }
    }
  }

  /// @param most largest number of samples of the beam
  BeamDensity of(int beam, const BeamState& state, double most) const {
    const BeamDensity& now = state.density;
    const BeamEstimate& estimate = state.estimate;
    const double by_columns = miss(estimate.columns_total, estimate.columns_centroid_lines, targets_.beam);
    const double by_rows = miss(estimate.rows_total, estimate.rows_centroid_lines, targets_.beam);
    const double bins = bin_rms(state) / most_bin_rms_;
    const double both = bins > 1 ? std::min(std::pow(bins, 0.5 / bin_order), longest_stride) : 1.0;
    const int rows =
        std::min(round_up_to_even(now.rows * round_up(std::max(finer_factor(by_rows, is_last_), both))),
                 finest_rows(aperture_));
    const bool misses_thin_things = !now.has_zone() && state.least_columns > now.columns;
    if (by_columns > 1 && by_rows <= 1 && bins <= 1 && !misses_thin_things) {
      const BeamDensity zone = with_zone(aperture_, beam, state);
      if (zone.has_zone() && zone.samples() <= most) {
        return zone;
      }
    }
    if (now.has_zone()) {
      return now;  // a zone is not refined further
    }
    BeamDensity wanted = now;
    wanted.columns =
        std::max(round_up_to_even(now.columns * round_up(std::max(finer_factor(by_columns, is_last_), both))),
                 std::max(least_columns_, state.least_columns));
    wanted.columns = std::max(now.columns, std::min(wanted.columns, most_columns));
    wanted.rows = std::max(now.rows, rows);
    return capped(wanted, now, most);
  }

 private:
  const Aperture& aperture_;
  const GridTargets& targets_;
  const bool is_last_;
  const double most_bin_rms_;
  int least_columns_ = 0;
};

}  // namespace

GridTargets grid_targets(Sampling::Preset preset) {
  return preset == Sampling::Preset::fast ? GridTargets{0.05, {0.005, 0.25}}
                                          : GridTargets{0.01, {0.001, 0.05}};
}

BeamError most_estimated_error(Sampling::Preset preset) {
  const BeamError target = grid_targets(preset).beam;
  return {target.total / beam_safety, target.centroid_lines / beam_safety};
}

int most_passes(Sampling::Preset preset) {
  return preset == Sampling::Preset::normal ? 3 : 2;
}

double error_of_distance(Sampling::Preset preset, int pass) {
  // Measured on the scenes of the benchmark (docs/accuracy.md).
  if (pass > 1) {
    return 0.2;
  }
  return preset == Sampling::Preset::reference ? 0.25 : 0.3;
}

int finest_rows(const Aperture& aperture) {
  int rows = least_rows(aperture);
  while (2 * rows <= std::min(most_pixels, most_rows_factor * least_rows(aperture))) {
    rows *= 2;
  }
  return rows;
}

int paired_rows(const Aperture& aperture) {
  return 2 * first_rows_factor * least_rows(aperture);
}

BeamDensity first_density(const Aperture& aperture, Sampling::Preset preset) {
  check_aperture(aperture);
  const int rows = least_rows(aperture);
  BeamDensity density{4, first_rows_factor * rows, 0, 0, 0, 0};
  if (preset == Sampling::Preset::fast) {
    density = {2, first_rows_factor * rows, 0, 0, 0, 0};
  } else if (preset == Sampling::Preset::reference) {
    density = {32, finest_rows(aperture), 0, 0, 0, 0};
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

BeamRun even_run(const Aperture& aperture, int begin, int end, const BeamDensity& density) {
  return run_of(aperture, begin, end, density);
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

std::vector<BeamChoice> beams_to_refine(const Aperture& aperture, const std::vector<BeamState>& beams,
                                        const GridTargets& targets, bool is_last) {
  const NextPass next(aperture, beams, targets, is_last);
  std::vector<BeamChoice> choices;
  for (double most = most_beam_samples;; most /= 2) {
    choices.clear();
    double samples = 0;
    for (std::size_t b = 0; b < beams.size(); ++b) {
      const BeamDensity& now = beams[b].density;
      const BeamDensity density = next.of(static_cast<int>(b), beams[b], most);
      if (density != now) {
        choices.push_back({static_cast<int>(b), density});
      }
    }
    share_views(choices);
    for (const BeamChoice& choice : choices) {
      samples += choice.density.samples();
    }
    if (samples <= most_samples) {
      return choices;
    }
  }
}

}  // namespace sonard::render
