// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/beam_refinement.hpp"

#include <algorithm>
#include <utility>

#include "renderer/stopwatch.hpp"

namespace sonard::render {

namespace {

constexpr int most_passes = 3;
constexpr double most_samples_at_once = 0x1p23;  // what is drawn before it is binned

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

/// One ping in the making.
struct BeamRefinement::Ping {
  BeamRefinement& refinement;
  const EchoRequest& request;
  const SurfaceModel& surface;
  PingStatistics& statistics;
  std::vector<BeamState> beams;

  void sample(const Grid& grid) {
    Stopwatch watch;
    const auto textures = refinement.sampler_.draw(request.T_world_sonar, grid.samples, surface,
                                                   request.settings.range.sampled_range_m());
    statistics.visibility_s += watch.lap();
    refinement.binner_.add(*grid.on_gpu, textures);
  }

  /// Takes what the GPU has estimated of the beams of these grids, which are those of the choices.
  void learn(const std::vector<Grid>& grids, const std::vector<BeamChoice>& choices) {
    const std::vector<BeamEstimate> estimates = refinement.binner_.take_estimates();
    std::size_t i = 0;
    for (const Grid& grid : grids) {
      const SampleGrid& samples = grid.samples;
      for (int b = 0; b < samples.beam_count(); ++b, ++i) {
        const int first = samples.beam_parts[static_cast<std::size_t>(b)];
        const int end = samples.beam_parts[static_cast<std::size_t>(b) + 1];
        const auto part = [&](int column) -> const ColumnPart& {
          return samples.parts[static_cast<std::size_t>(first + column)];
        };
        const BeamEstimate& estimate = estimates[i];
        beams[static_cast<std::size_t>(choices[i].beam)] = {
            choices[i].density,
            estimate,
            statistics.passes > 1,
            end - first,
            samples.port_rad(part(estimate.zone_begin)),
            samples.starboard_rad(part(estimate.zone_end - 1))};
      }
    }
  }

  /// The runs of the beams on one page of the image. A part of them at a time, so that the memory taken does
  /// not grow with their number.
  void sample_page(const std::vector<BeamChoice>& choices, bool with_estimate, std::vector<Grid>& grids) {
    const Aperture& aperture = request.settings.aperture;
    const std::vector<BeamRun> runs = beam_runs(aperture, choices);
    for (auto run = runs.begin(); run != runs.end();) {
      std::vector<BeamRun> part;
      double samples = 0;
      do {
        samples += run->samples();
        part.push_back(*run++);
      } while (run != runs.end() && samples + run->samples() <= most_samples_at_once);
      Stopwatch watch;
      grids.push_back(refinement.make_grid(aperture, part, with_estimate));
      statistics.preparing_s += watch.lap();
      sample(grids.back());
    }
  }

  void refine(const std::vector<BeamChoice>& choices, bool with_estimate) {
    const int beams_per_page = refinement.binner_.beams_per_page();
    std::vector<Grid> grids;
    for (auto first = choices.begin(); first != choices.end();) {
      const int page = first->beam / beams_per_page;
      const auto end = std::find_if(first, choices.end(), [&](const BeamChoice& choice) {
        return choice.beam / beams_per_page != page;
      });
      sample_page({first, end}, with_estimate, grids);
      first = end;
    }
    if (with_estimate) {
      learn(grids, choices);
    }
  }
};

BeamRefinement::Grid BeamRefinement::make_grid(const Aperture& aperture, const std::vector<BeamRun>& runs,
                                               bool with_estimate) const {
  Grid grid{make_sample_grid(aperture, runs), nullptr};
  if (with_estimate) {
    const SampleGrid coarse = make_sample_grid(aperture, thinned(runs));
    grid.on_gpu = binner_.load(grid.samples, beams_of(runs), &coarse);
  } else {
    grid.on_gpu = binner_.load(grid.samples, beams_of(runs));
  }
  return grid;
}

const BeamRefinement::EvenGrids& BeamRefinement::even_grids(const Aperture& aperture,
                                                            const BeamDensity& density) {
  even_.reset();
  const int beams_per_page = binner_.beams_per_page();
  std::vector<Grid> grids;
  for (int begin = 0; begin < aperture.beam_count(); begin += beams_per_page) {
    const int end = std::min(begin + beams_per_page, aperture.beam_count());
    grids.push_back(make_grid(aperture, {even_run(aperture, begin, end, density)}, true));
  }
  even_ = {aperture, density, beams_per_page, std::move(grids)};
  return *even_;
}

bool BeamRefinement::refine(const EchoRequest& request, const SurfaceModel& surface, bool keep_grid,
                            PingStatistics& statistics) {
  const Aperture& aperture = request.settings.aperture;
  const Sampling::Preset preset = request.settings.sampling.preset;
  const BeamDensity density = first_density(aperture, preset);
  const bool known = keep_grid && even_ && even_->density == density && even_->aperture == aperture &&
                     even_->beams_per_page == binner_.beams_per_page();
  const EvenGrids& even = known ? *even_ : even_grids(aperture, density);
  const auto beams = static_cast<std::size_t>(aperture.beam_count());
  Ping ping{*this, request, surface, statistics, std::vector<BeamState>(beams)};
  std::vector<BeamChoice> choices(beams);
  for (std::size_t beam = 0; beam < beams; ++beam) {
    choices[beam] = {static_cast<int>(beam), density};
  }
  ++statistics.passes;
  for (const Grid& grid : even.grids) {
    ping.sample(grid);
  }
  ping.learn(even.grids, choices);
  for (int pass = 2; pass <= most_passes; ++pass) {
    Stopwatch watch;
    choices = beams_to_refine(aperture, ping.beams, grid_targets(preset));
    statistics.preparing_s += watch.lap();
    if (choices.empty()) {
      break;
    }
    ++statistics.passes;
    ping.refine(choices, pass < most_passes);
  }
  return known;
}

}  // namespace sonard::render
