// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/cpu_engine.hpp"

#include <utility>

#include "renderer/binning/direction_echoes.hpp"
#include "renderer/engines/cpu/slice_binner.hpp"
#include "renderer/sample_grid/grid_binner.hpp"
#include "renderer/scene/refracted_world.hpp"
#include "renderer/stopwatch.hpp"
#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

namespace {

std::unique_ptr<SpatialIndex> bendable_index(const World& world, WorkerPool& workers,
                                             double curvature_per_m) {
  return curvature_per_m == 0.0
             ? nullptr
             : std::make_unique<SpatialIndex>(refractable(world, curvature_per_m), workers);
}

}  // namespace

CpuEngine::CpuEngine(SpatialIndex& index, WorkerPool& workers, const RendererOptions& options)
    : skip_(options.skip),
      largest_response_(largest_response(index.world())),
      workers_(workers),
      bendable_(bendable_index(index.world(), workers, options.ray_curvature_per_m)),
      slices_(bendable_ ? bendable_->world() : index.world(), workers, slice_switches(options)),
      rays_(bendable_ ? *bendable_ : index, workers),
      description_("cpu, " + index.description()) {}

void CpuEngine::set_body_pose(std::size_t body, const Pose& T_world_body) {
  slices_.set_body_pose(body, T_world_body);
  if (bendable_) {
    bendable_->set_body_pose(body, T_world_body);
  }
}

void CpuEngine::set_part_meshes(std::span<const PartMesh> changes) {
  slices_.set_part_meshes(changes);
  if (bendable_) {
    bendable_->set_part_meshes(changes);
  }
}

void CpuEngine::set_refraction(double bend_per_m) {
  slices_.set_refraction(bend_per_m);
  rays_.set_refraction(bend_per_m);
}

void CpuEngine::images(std::span<const EchoJob> jobs) {
  for (const auto& [request, echo, statistics] : jobs) {
    const BinningOptions options = binning_options(request, skip_, largest_response_);
    if (needs_grid(request.settings)) {
      image_by_grid(request, options, echo, statistics);
    } else {
      image_by_slices(request, options, echo, statistics);
    }
  }
}

void CpuEngine::image_by_grid(const EchoRequest& request, const BinningOptions& options, MeanEcho& echo,
                              PingStatistics& statistics) {
  Stopwatch watch;
  const SonarSettings& settings = request.settings;
  if (grid_.prepare(settings.aperture, settings.sampling, grid_options(settings),
                    skip_.on(SkipRule::unchanged_settings))) {
    statistics.skipped.add(SkipRule::unchanged_settings);
  }
  const auto views = rays_.sample(request.T_world_sonar, grid_.grid(), surface_model(settings, skip_),
                                  settings.range.sampled_range_m());
  statistics.seconds.visibility += watch.lap();
  hand_over(bin_samples(grid_.grid(), grid_.weights(), views, settings.range, options, workers_,
                        std::move(echo.image.intensity)),
            echo, statistics);
  statistics.seconds.binning += watch.lap();
}

void CpuEngine::image_by_slices(const EchoRequest& request, const BinningOptions& options, MeanEcho& echo,
                                PingStatistics& statistics) {
  Stopwatch watch;
  const SonarSettings& settings = request.settings;
  const auto cells = slices_.sample(request.T_world_sonar, settings.aperture, settings.range,
                                    settings.range.sampled_range_m(), surface_model(settings, skip_),
                                    slice_accuracy(settings.sampling, settings.model));
  statistics.seconds.visibility += watch.lap();
  statistics.skipped += slices_.skipped();
  if (settings.directions.any()) {
    const SeenPatches seen = see_patches(slices_, cells, workers_);
    statistics.seconds.visibility += watch.lap();
    echo.directions =
        find_directions(seen, settings.directions, settings.range, *request.loss_of_bin, workers_);
    statistics.samples += seen.patches.size();
    statistics.seconds.binning += watch.lap();
    return;
  }
  BinningResult bins = bin_echoes(slices_, cells, settings.aperture, settings.range, options, workers_,
                                  std::move(echo.image.intensity));
  statistics.seconds.visibility += bins.shading_s;
  statistics.seconds.binning += watch.lap() - bins.shading_s;
  hand_over(std::move(bins), echo, statistics);
}

}  // namespace sonard::render
