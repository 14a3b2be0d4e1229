// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/beam_refinement.hpp"

#include <algorithm>
#include <utility>

#include "renderer/stopwatch.hpp"

namespace sonard::render {

namespace {

constexpr std::size_t most_even_grids = 8;
constexpr double most_samples_at_once = 0x1p23;  // drawn before they are binned

/// The beams of some runs, one run after the other.
std::vector<int> beams_of(const std::vector<BeamRun>& runs) {
  std::vector<int> beams;
  for (const BeamRun& run : runs) {
    for (int beam = run.begin; beam < run.end; ++beam) {
      beams.push_back(beam);
    }
  }
  return beams;
}

}  // namespace

BeamRefinement::Grid BeamRefinement::make_grid(GpuBinner& binner, const Aperture& aperture,
                                               const std::vector<BeamRun>& runs, bool with_estimate) {
  Grid grid{std::make_shared<const SampleGrid>(make_sample_grid(aperture, runs)), nullptr};
  if (with_estimate) {
    const SampleGrid coarse = make_sample_grid(aperture, thinned(runs));
    grid.on_gpu = binner.load(*grid.samples, beams_of(runs), &coarse);
  } else {
    grid.on_gpu = binner.load(*grid.samples, beams_of(runs));
  }
  return grid;
}

/// Null if there are no such grids.
const BeamRefinement::EvenGrids* BeamRefinement::known_even_grids(const EvenGrids& wanted) {
  const auto known = std::find_if(even_.begin(), even_.end(), [&](const EvenGrids& grids) {
    return grids.density == wanted.density && grids.aperture == wanted.aperture &&
           grids.beams_per_page == wanted.beams_per_page;
  });
  if (known == even_.end()) {
    return nullptr;
  }
  even_.splice(even_.begin(), even_, known);
  return &even_.front();
}

const BeamRefinement::EvenGrids& BeamRefinement::make_even_grids(GpuBinner& binner, EvenGrids wanted) {
  const int beams = wanted.aperture.beam_count();
  for (int begin = 0; begin < beams; begin += wanted.beams_per_page) {
    const int end = std::min(begin + wanted.beams_per_page, beams);
    wanted.grids.push_back(
        make_grid(binner, wanted.aperture, {even_run(wanted.aperture, begin, end, wanted.density)}, true));
  }
  if (even_.size() == most_even_grids) {
    even_.pop_back();
  }
  return even_.emplace_front(std::move(wanted));
}

std::unique_ptr<BeamRefinement::Ping> BeamRefinement::begin(GpuBinner& binner, const EchoRequest& request,
                                                            const SurfaceModel& surface, bool keep_grid,
                                                            PingStatistics& statistics) {
  const Aperture& aperture = request.settings.aperture;
  const EvenGrids wanted{
      aperture, first_density(aperture, request.settings.sampling.preset), binner.beams_per_page(), {}};
  const EvenGrids* even = keep_grid ? known_even_grids(wanted) : nullptr;
  if (even != nullptr) {
    statistics.skipped.add(SkipRule::unchanged_settings);
  } else {
    even = &make_even_grids(binner, wanted);
  }
  auto ping = std::make_unique<Ping>(sampler_, thin_things_, binner, request, surface, statistics);
  ping->sample_evenly(*even);
  return ping;
}

BeamRefinement::Ping::Ping(RasterSampler& sampler, const ThinThings& thin_things, GpuBinner& binner,
                           const EchoRequest& request, const SurfaceModel& surface,
                           PingStatistics& statistics)
    : sampler_(sampler),
      binner_(binner),
      request_(request),
      surface_(surface),
      statistics_(statistics),
      least_columns_(thin_things.least_columns(request.T_world_sonar, request.settings.aperture,
                                               request.settings.range.sampled_range_m())),
      beams_(static_cast<std::size_t>(request.settings.aperture.beam_count())),
      choices_(beams_.size()) {}

void BeamRefinement::Ping::sample(const Grid& grid) {
  Stopwatch watch;
  const unsigned samples = sampler_.draw(request_.T_world_sonar, *grid.samples, surface_,
                                         request_.settings.range.sampled_range_m());
  statistics_.visibility_s += watch.lap();
  binner_.add(*grid.on_gpu, samples);
}

void BeamRefinement::Ping::sample_evenly(const EvenGrids& even) {
  for (std::size_t beam = 0; beam < choices_.size(); ++beam) {
    choices_[beam] = {static_cast<int>(beam), even.density};
  }
  grids_ = even.grids;
  for (const Grid& grid : grids_) {
    sample(grid);
  }
  binner_.ask_estimates();
  pass_ = 1;
  ++statistics_.passes;
}

bool BeamRefinement::Ping::advance() {
  learn();
  const Sampling::Preset preset = request_.settings.sampling.preset;
  const bool is_last = pass_ + 1 == most_passes(preset);
  Stopwatch watch;
  choices_ = beams_to_refine(request_.settings.aperture, beams_, grid_targets(preset), is_last);
  statistics_.preparing_s += watch.lap();
  if (choices_.empty()) {
    return false;
  }
  ++pass_;
  ++statistics_.passes;
  sample_again(!is_last);
  if (!is_last) {
    binner_.ask_estimates();
  }
  return !is_last;
}

/// Takes the GPU's estimates of the beams of the last pass.
void BeamRefinement::Ping::learn() {
  const std::vector<BeamEstimate> estimates = binner_.take_estimates();
  const double share = error_of_distance(request_.settings.sampling.preset, pass_);
  std::size_t i = 0;
  for (const Grid& grid : grids_) {
    const SampleGrid& samples = *grid.samples;
    for (int b = 0; b < samples.beam_count(); ++b, ++i) {
      const int first = samples.beam_parts[static_cast<std::size_t>(b)];
      const int end = samples.beam_parts[static_cast<std::size_t>(b) + 1];
      const auto part = [&](int column) -> const ColumnPart& {
        return samples.parts[static_cast<std::size_t>(first + column)];
      };
      const BeamEstimate& estimate = estimates[i];
      beams_[static_cast<std::size_t>(choices_[i].beam)] = {
          choices_[i].density,
          estimate,
          share,
          end - first,
          samples.port_rad(part(estimate.zone_begin)),
          samples.starboard_rad(part(estimate.zone_end - 1)),
          least_columns_[static_cast<std::size_t>(choices_[i].beam)]};
    }
  }
}

/// Samples the runs of the beams on one page of the image, a part of them at a time, so that memory does not
/// grow with their number.
void BeamRefinement::Ping::sample_page(const std::vector<BeamChoice>& choices, bool with_estimate) {
  const Aperture& aperture = request_.settings.aperture;
  const std::vector<BeamRun> runs = beam_runs(aperture, choices);
  for (auto run = runs.begin(); run != runs.end();) {
    std::vector<BeamRun> part;
    double samples = 0;
    do {
      samples += run->samples();
      part.push_back(*run++);
    } while (run != runs.end() && samples + run->samples() <= most_samples_at_once);
    Stopwatch watch;
    grids_.push_back(make_grid(binner_, aperture, part, with_estimate));
    statistics_.preparing_s += watch.lap();
    sample(grids_.back());
  }
}

void BeamRefinement::Ping::sample_again(bool with_estimate) {
  const int beams_per_page = binner_.beams_per_page();
  grids_.clear();
  for (auto first = choices_.begin(); first != choices_.end();) {
    const int page = first->beam / beams_per_page;
    const auto end = std::find_if(first, choices_.end(), [&](const BeamChoice& choice) {
      return choice.beam / beams_per_page != page;
    });
    sample_page({first, end}, with_estimate);
    first = end;
  }
}

}  // namespace sonard::render
