// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/beam_refinement.hpp"

#include <algorithm>
#include <chrono>

#include "renderer/sample_grid/grid_binner.hpp"

namespace sonard::render {

namespace {

constexpr int most_passes = 5;
constexpr double most_samples_at_once = 0x1p23;  // what is drawn before it is read and binned

}  // namespace

/// One ping in the making.
struct BeamRefinement::Ping {
  RasterSampler& sampler;
  WorkerPool& workers;
  const Request& request;
  std::vector<BeamState> beams;
  Result result;

  /// Samples some beams and bins them: in place of what the image has of them.
  /// @param coarse the grid thinned; null: no error estimate is needed.
  void sample_pass(const SampleGrid& grid, const SampleGrid* coarse, const std::vector<BeamChoice>& choices) {
    const auto begin = std::chrono::steady_clock::now();
    const auto views = sampler.sample(request.T_world_sonar, grid, request.surface, request.max_range_m);
    result.visibility_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const BinningResult bins = bin_echoes(grid, views, request.settings.range, request.binning, workers);
    const auto lines = static_cast<std::size_t>(bins.lines);
    for (std::size_t i = 0; i < choices.size(); ++i) {
      const std::size_t beam = static_cast<std::size_t>(choices[i].beam) * lines;
      std::copy_n(&bins.echo[i * lines], lines, &result.bins.echo[beam]);
      if (request.binning.open_water) {
        std::copy_n(&bins.open_sr[i * lines], lines, &result.bins.open_sr[beam]);
      }
    }
    result.bins.samples += bins.samples;
    result.bins.invalid_samples += bins.invalid_samples;
    if (coarse != nullptr) {
      estimate_beams(grid, views, bins, *coarse, choices);
    }
  }

  void estimate_beams(const SampleGrid& grid, const std::vector<const SurfaceSample*>& views,
                      const BinningResult& bins, const SampleGrid& coarse,
                      const std::vector<BeamChoice>& choices) {
    const RangeLines& range = request.settings.range;
    const ThinnedSamples thinned(grid, views, coarse);
    const BinningResult coarse_bins = bin_echoes(coarse, thinned.views(), range, request.binning, workers);
    std::vector<BeamErrorEstimate> estimate =
        estimate_errors(grid, views, range, request.line_weight, workers);
    const auto lines = static_cast<std::size_t>(bins.lines);
    for (std::size_t i = 0; i < choices.size(); ++i) {
      beams[static_cast<std::size_t>(choices[i].beam)] = {
          choices[i].density, std::move(estimate[i]),
          bin_error(&bins.echo[i * lines], &coarse_bins.echo[i * lines], lines, request.line_weight)};
    }
  }

  /// A part of the runs at a time, so that the memory taken does not grow with their number.
  void refine_pass(const std::vector<BeamChoice>& choices, bool with_estimate) {
    const Aperture& aperture = request.settings.aperture;
    const std::vector<BeamRun> runs = beam_runs(aperture, choices);
    auto first = choices.begin();
    for (auto run = runs.begin(); run != runs.end();) {
      std::vector<BeamRun> part;
      auto last = first;
      double samples = 0;
      do {
        samples += run->samples();
        last += run->end - run->begin;
        part.push_back(*run++);
      } while (run != runs.end() && samples + run->samples() <= most_samples_at_once);
      const SampleGrid grid = make_sample_grid(aperture, part);
      if (with_estimate) {
        const SampleGrid coarse = make_sample_grid(aperture, thinned(part));
        sample_pass(grid, &coarse, {first, last});
      } else {
        sample_pass(grid, nullptr, {first, last});
      }
      first = last;
    }
  }
};

const BeamRefinement::EvenGrid& BeamRefinement::even_grid(const Aperture& aperture,
                                                          const BeamDensity& density) {
  even_.reset();
  const std::vector<BeamRun> run{whole_fan(aperture, density)};
  even_ = {aperture, density, make_sample_grid(aperture, run), make_sample_grid(aperture, thinned(run))};
  return *even_;
}

BeamRefinement::Result BeamRefinement::refine(const Request& request, bool keep_grid) {
  const SonarSettings& settings = request.settings;
  const Aperture& aperture = settings.aperture;
  const Sampling::Preset preset = settings.sampling.preset;
  const BeamDensity density = first_density(aperture, preset);
  const bool known = keep_grid && even_ && even_->density == density && even_->aperture == aperture;
  const EvenGrid& even = known ? *even_ : even_grid(aperture, density);
  const auto beams = static_cast<std::size_t>(aperture.beam_count());
  Ping ping{sampler_, workers_, request, std::vector<BeamState>(beams), {}};
  ping.result.known_grid = known;
  ping.result.bins.beams = aperture.beam_count();
  ping.result.bins.lines = settings.range.count;
  ping.result.bins.echo.resize(beams * static_cast<std::size_t>(settings.range.count));
  ping.result.bins.open_sr.resize(request.binning.open_water ? ping.result.bins.echo.size() : 0);
  std::vector<BeamChoice> choices(beams);
  for (std::size_t beam = 0; beam < beams; ++beam) {
    choices[beam] = {static_cast<int>(beam), density};
  }
  ping.sample_pass(even.grid, &even.coarse, choices);
  for (int pass = 2; pass <= most_passes; ++pass) {
    choices = beams_to_refine(aperture, ping.beams, grid_targets(preset));
    if (choices.empty()) {
      break;
    }
    ping.refine_pass(choices, pass < most_passes);
  }
  return std::move(ping.result);
}

}  // namespace sonard::render
