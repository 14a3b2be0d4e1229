// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gpu_engine.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/errors.hpp"
#include "renderer/sample_grid/grid_binner.hpp"
#include "renderer/scene/refracted_world.hpp"
#include "renderer/stopwatch.hpp"
#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

GpuEngine::GpuEngine(const World& world, WorkerPool& workers, const RendererOptions& options)
    : skip_(options.skip),
      largest_response_(largest_response(world)),
      workers_(workers),
      sampler_(options.ray_curvature_per_m == 0.0 ? world : refractable(world, options.ray_curvature_per_m)),
      binner_(sampler_),
      refinement_(sampler_, binner_) {}

GpuEngine::~GpuEngine() {
  sampler_.make_current_if_alive();
}

void GpuEngine::set_body_pose(std::size_t body, const Pose& T_world_body) {
  sampler_.set_body_pose(body, T_world_body);
}

void GpuEngine::set_part_meshes(std::span<const PartMesh> changes) {
  sampler_.set_part_meshes(changes);
}

void GpuEngine::set_refraction(double bend_per_m) {
  sampler_.set_refraction(bend_per_m);
}

void GpuEngine::image(const EchoRequest& request, MeanEcho& echo, PingStatistics& statistics) {
  const BinningOptions options = binning_options(request, skip_, largest_response_);
  if (options.cone_aperture != nullptr) {
    image_by_cones(request, options, echo, statistics);
    return;
  }
  Stopwatch watch;
  const double drawing_before_s = statistics.visibility_s;
  const RasterSampler::Drawn drawn_before = sampler_.drawn();
  const SonarSettings& settings = request.settings;
  binner_.begin({settings.aperture.beam_count(), settings.range, options, request.line_weight,
                 most_estimated_error(settings.sampling.preset)});
  const bool may_keep = skip_.on(SkipRule::unchanged_settings);
  const bool known_grid = needs_grid(settings) ? draw_grid(request, may_keep, statistics)
                                               : refinement_.refine(request, surface_model(settings, skip_),
                                                                    may_keep, statistics);
  if (known_grid) {
    statistics.skipped.add(SkipRule::unchanged_settings);
  }
  hand_over(binner_.finish(std::move(echo.image.intensity)), echo, statistics);
  count_work(drawn_before, statistics);
  statistics.binning_s += watch.lap() - (statistics.visibility_s - drawing_before_s);
}

void GpuEngine::count_work(const RasterSampler::Drawn& before, PingStatistics& statistics) const {
  statistics.bytes_read_back += binner_.bytes_read();
  statistics.synchronisations += binner_.synchronisations();
  statistics.bytes_uploaded += binner_.bytes_uploaded();
  statistics.atomic_additions += binner_.atomic_additions();
  const RasterSampler::Drawn now = sampler_.drawn();
  statistics.views += now.views - before.views;
  statistics.pixels += now.pixels - before.pixels;
  statistics.draw_calls += now.draw_calls - before.draw_calls;
  statistics.triangles += now.triangles - before.triangles;
  statistics.preparing_s += now.culling_s - before.culling_s;
}

/// @return whether the grid is the one of the last ping.
bool GpuEngine::draw_grid(const EchoRequest& request, bool may_keep, PingStatistics& statistics) {
  const int beams = request.settings.aperture.beam_count();
  const int beams_per_page = binner_.beams_per_page();
  const bool known = grid_.prepare(request.settings, may_keep) && grid_page_ == beams_per_page;
  if (!known) {
    grid_on_gpu_.clear();
    for (int begin = 0; begin < beams; begin += beams_per_page) {
      const int end = std::min(begin + beams_per_page, beams);
      std::vector<int> in_image(static_cast<std::size_t>(end - begin));
      std::iota(in_image.begin(), in_image.end(), begin);
      grid_on_gpu_.push_back(binner_.load(part_of(grid_.grid(), begin, end), in_image));
    }
    grid_page_ = beams_per_page;
  }
  Stopwatch watch;
  const auto textures =
      sampler_.draw(request.T_world_sonar, grid_.grid(), surface_model(request.settings, skip_),
                    request.settings.range.sampled_range_m());
  statistics.visibility_s += watch.lap();
  for (const auto& page : grid_on_gpu_) {
    binner_.add(*page, textures);
  }
  ++statistics.passes;
  return known;
}

/// Beams that are told apart by cones: the one image whose samples are read back.
void GpuEngine::image_by_cones(const EchoRequest& request, const BinningOptions& options, MeanEcho& echo,
                               PingStatistics& statistics) {
  constexpr int views = 3;
  constexpr int columns = 512;
  constexpr int rows = 512;
  SonarSettings settings = request.settings;
  if (!needs_grid(settings)) {
    // Beams that are sampled again by themselves would miss what their neighbours saw for them.
    settings.sampling = Sampling::of_grid(views, columns, rows);
  }
  Stopwatch watch;
  if (cone_grid_.prepare(settings, skip_.on(SkipRule::unchanged_settings))) {
    statistics.skipped.add(SkipRule::unchanged_settings);
  }
  const auto samples = sampler_.sample(request.T_world_sonar, cone_grid_.grid(),
                                       surface_model(settings, skip_), settings.range.sampled_range_m());
  statistics.visibility_s += watch.lap();
  hand_over(bin_echoes(cone_grid_.grid(), cone_grid_.weights(), samples, settings.range, options, workers_,
                       std::move(echo.image.intensity)),
            echo, statistics);
  statistics.binning_s += watch.lap();
}

}  // namespace sonard::render
