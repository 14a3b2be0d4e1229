// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gpu_engine.hpp"

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
      description_(sampler_.description()),
      refinement_(sampler_, workers) {
  make_binner(options.gpu_binning);
}

/// Says in the description what it can.
void GpuEngine::make_binner(GpuBinning wanted) {
  const bool hardware = !is_software_gl(description_);
  if (wanted == GpuBinning::off || (wanted == GpuBinning::automatic && !hardware)) {
    return;
  }
  try {
    binner_.emplace(sampler_);
    description_ += "; fixed grids are binned by it too";
  } catch (const RendererError& error) {
    if (wanted == GpuBinning::on) {
      throw;
    }
    description_ += std::string("; it cannot bin: ") + error.what();
  }
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
  if (needs_grid(request.settings)) {
    image_by_grid(request, options, echo, statistics);
  } else if (options.cone_aperture != nullptr) {
    // Beams that are sampled again by themselves would miss what their neighbours saw for them.
    constexpr int views = 3;
    constexpr int columns = 512;
    constexpr int rows = 512;
    SonarSettings even = request.settings;
    even.sampling = Sampling::of_grid(views, columns, rows);
    image_by_grid({request.T_world_sonar, even, request.line_weight, request.open_water}, options, echo,
                  statistics);
  } else {
    image_by_refinement(request, options, echo, statistics);
  }
}

void GpuEngine::image_by_grid(const EchoRequest& request, const BinningOptions& options, MeanEcho& echo,
                              PingStatistics& statistics) {
  Stopwatch watch;
  const SonarSettings& settings = request.settings;
  if (grid_.prepare(settings, skip_.on(SkipRule::unchanged_settings))) {
    statistics.skipped.add(SkipRule::unchanged_settings);
  } else if (binner_) {
    binner_->set_grid(grid_.grid());
  }
  bool on_gpu = binner_ && options.cone_aperture == nullptr;
  if (on_gpu) {
    statistics.gpu_binning_obstacle = binner_->make_room(settings.range.count, options);
    on_gpu = statistics.gpu_binning_obstacle.empty();
  }
  const SurfaceModel surface = surface_model(settings, skip_);
  const double range_m = settings.range.sampled_range_m();
  std::vector<float> memory = std::move(echo.image.intensity);
  if (on_gpu) {
    const auto textures = sampler_.draw(request.T_world_sonar, grid_.grid(), surface, range_m);
    statistics.visibility_s += watch.lap();
    hand_over(binner_->bin(textures, settings.range, options, std::move(memory)), echo, statistics);
  } else {
    const auto views = sampler_.sample(request.T_world_sonar, grid_.grid(), surface, range_m);
    statistics.visibility_s += watch.lap();
    hand_over(bin_echoes(grid_.grid(), views, settings.range, options, workers_, std::move(memory)), echo,
              statistics);
  }
  statistics.binning_s += watch.lap();
}

void GpuEngine::image_by_refinement(const EchoRequest& request, const BinningOptions& options, MeanEcho& echo,
                                    PingStatistics& statistics) {
  Stopwatch watch;
  const SonarSettings& settings = request.settings;
  const SurfaceModel surface = surface_model(settings, skip_);
  BeamRefinement::Result found =
      refinement_.refine({request.T_world_sonar, settings, surface, settings.range.sampled_range_m(), options,
                          request.line_weight},
                         skip_.on(SkipRule::unchanged_settings));
  if (found.known_grid) {
    statistics.skipped.add(SkipRule::unchanged_settings);
  }
  hand_over(std::move(found.bins), echo, statistics);
  statistics.visibility_s += found.visibility_s;
  statistics.binning_s += watch.lap() - found.visibility_s;
}

}  // namespace sonard::render
