// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gpu_engine.hpp"

#include <algorithm>
#include <utility>

#include "renderer/engines/slices/first_slices.hpp"
#include "renderer/errors.hpp"
#include "renderer/sample_grid/grid_binner.hpp"
#include "renderer/scene/refracted_world.hpp"
#include "renderer/stopwatch.hpp"
#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

namespace {

GpuWork work_of(const PingCounts& counts, std::uint64_t dispatches) {
  const records::Room& needed = counts.needed;
  return {dispatches,    needed.triangles, needed.entries, counts.rounds,
          needed.slices, counts.segments,  needed.visible, counts.additions};
}

World drawn_world(const World& world, const RendererOptions& options) {
  return options.ray_curvature_per_m == 0.0 ? world : refractable(world, options.ray_curvature_per_m);
}

}  // namespace

GpuEngine::GpuEngine(const World& world, WorkerPool& workers, const RendererOptions& options)
    : skip_(options.skip),
      memory_bound_bytes_(options.gpu.memory_mib << 20U),
      largest_response_(largest_response(world)),
      drawn_(drawn_world(world, options)),
      workers_(workers),
      images_until_lost_(options.gpu.lose_context_at_image),
      context_(EglContext::made_current(options.gpu.device)),
      description_("gpu, " + context_->describe()),
      world_(drawn_, slice_switches(options)),
      slices_(*context_, options.gpu),
      echoes_(slices_.compute()) {}

GpuEngine::~GpuEngine() {
  context_->makeCurrent();  // fails if the context is lost, and its buffers with it
}

void GpuEngine::set_body_pose(std::size_t body, const Pose& T_world_body) {
  world_.set_body_pose(body, T_world_body);
  drawn_.bodies[body].T_world_body = T_world_body;
}

void GpuEngine::set_part_meshes(std::span<const PartMesh> changes) {
  world_.set_part_meshes(changes, workers_);
  replace_meshes(drawn_, changes);
}

void GpuEngine::set_refraction(double bend_per_m) {
  world_.set_refraction(bend_per_m);
}

void GpuEngine::images(std::span<const EchoJob> jobs) {
  std::vector<EchoJob> by_slices;
  for (const EchoJob& job : jobs) {
    if (images_until_lost_ > 0 && --images_until_lost_ == 0) {
      context_->make_current_or_throw();
      context_->lose();
    }
    const BinningOptions options = binning_options(job.request, skip_, largest_response_);
    const SonarSettings& settings = job.request.settings;
    if (settings.directions.any()) {
      throw RequestError("directions come from the CPU");
    }
    if (options.cone_aperture != nullptr || needs_grid(settings)) {
      image_by_grid(job, options);
    } else if (settings.sampling.within_facets) {
      throw RequestError("masks of facets are made by engine cpu");
    } else {
      by_slices.push_back(job);
    }
  }
  for (std::size_t done = 0; done < by_slices.size(); done += most_pings) {
    images_by_slices(std::span(by_slices).subspan(done, std::min(most_pings, by_slices.size() - done)));
  }
}

/// A ping in flight.
struct GpuEngine::Ping {
  const EchoJob& job;
  PingBuffers& buffers;
  GpuPing setting;
};

void GpuEngine::images_by_slices(std::span<const EchoJob> jobs) {
  if (jobs.empty()) {
    return;
  }
  context_->make_current_or_throw();
  while (buffers_.size() < jobs.size()) {
    buffers_.push_back(std::make_unique<PingBuffers>(slices_.compute().gl()));
  }
  std::vector<Ping> pings;
  pings.reserve(jobs.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    pings.push_back({jobs[i], *buffers_[i], {jobs[i].request, skip_, largest_response_}});
  }
  std::ranges::for_each(pings, [&](Ping& ping) { begin(ping); });
  std::ranges::for_each(pings, [&](Ping& ping) { finish(ping); });
  context_->check();
}

/// Gives all work of a ping to the GPU.
void GpuEngine::begin(Ping& ping) {
  PingStatistics& statistics = ping.job.statistics;
  Stopwatch watch;
  const std::uint64_t uploaded_before = slices_.meshes().bytes_uploaded();
  const std::uint64_t dispatched_before = slices_.compute().dispatches();
  slices_.compute().begin_stages();
  world_.place(ping.job.request.T_world_sonar);
  GpuPing& setting = ping.setting;
  setting.bend = world_.bend();
  setting.may_be_seen = GpuSlices::may_be_seen(world_.parts(), setting);
  echoes_.surfaces().hold(world_.surfaces(), world_.version(), setting.may_be_seen);
  setting.surface_bytes = echoes_.surfaces().bytes();
  slices_.find(ping.buffers, world_.parts(), setting);
  slices_.see(ping.buffers, setting);
  statistics.seconds.visibility += watch.lap();
  echoes_.make(ping.buffers, world_.surfaces(), setting);
  statistics.seconds.binning += watch.lap();
  statistics.gpu.work.dispatches += slices_.compute().dispatches() - dispatched_before;
  statistics.gpu.bytes_uploaded += slices_.meshes().bytes_uploaded() - uploaded_before;
  statistics.gpu.video_memory_bytes = slices_.meshes().bytes() + echoes_.surfaces().bytes();
}

/// Waits for the result, and repeats the ping while one of its buffers is too small: the first pings of a
/// world only.
void GpuEngine::finish(Ping& ping) {
  constexpr int most_tries = 8;
  const auto& [request, echo, statistics] = ping.job;
  Stopwatch watch;
  std::optional<BinningResult> result;
  for (int tries = 0; tries < most_tries && !result; ++tries) {
    if (tries > 0) {
      begin(ping);
    }
    result = GpuEchoes::take(ping.buffers, ping.setting, std::move(echo.image.intensity));
    ++statistics.gpu.synchronisations;
    ++statistics.gpu.passes;
  }
  const PingCounts& counts = ping.buffers.counted;
  if (!result || counts.overflows > 0) {
    throw RequestError("this ping has more surfaces, edges or slices than fit on the GPU");
  }
  statistics.seconds.binning += watch.lap();
  statistics.gpu.bytes_read_back +=
      sizeof(PingCounts) + (result->echo.size() + result->open_sr.size()) * sizeof(float);
  statistics.gpu.stages_ms = slices_.compute().take_stages_ms();
  statistics.gpu.work = work_of(counts, statistics.gpu.work.dispatches);
  statistics.skipped += world_.skipped();
  statistics.skipped.add(SkipRule::culled_clusters, counts.culled_clusters);
  statistics.skipped.add(SkipRule::hidden_faces, counts.hidden_faces);
  statistics.skipped.add(SkipRule::flat_elevation,
                         skip_.on(SkipRule::flat_elevation) &&
                                 request.settings.aperture.elevation == Aperture::Elevation::top_hat
                             ? 1
                             : 0);
  hand_over(std::move(*result), echo, statistics);
}

/// Draws the samples of a fixed grid, and bins them on the CPU. With conical beams and a preset, the grid is
/// 3 views of 512 x 512.
void GpuEngine::image_by_grid(const EchoJob& job, const BinningOptions& options) {
  const auto& [request, echo, statistics] = job;
  const SonarSettings& settings = request.settings;
  const Sampling sampling = needs_grid(settings) ? settings.sampling : Sampling::of_grid(3, 512, 512);
  Stopwatch watch;
  if (grid_.prepare(settings.aperture, sampling, grid_options(settings),
                    skip_.on(SkipRule::unchanged_settings))) {
    statistics.skipped.add(SkipRule::unchanged_settings);
  }
  context_->make_current_or_throw();
  if (!raster_) {
    raster_ = std::make_unique<RasterSampler>(*context_, drawn_, memory_bound_bytes_);
  }
  const std::uint64_t uploaded_before = raster_->bytes_uploaded();
  const auto samples = raster_->sample(request.T_world_sonar, grid_.grid(), surface_model(settings, skip_),
                                       world_.bend().per_m, settings.range.sampled_range_m());
  statistics.gpu.bytes_uploaded += raster_->bytes_uploaded() - uploaded_before;
  for (const SubView& view : grid_.grid().views) {
    statistics.gpu.bytes_read_back += sizeof(SurfaceSample) * static_cast<std::uint64_t>(view.columns) *
                                      static_cast<std::uint64_t>(view.rows);
  }
  statistics.gpu.video_memory_bytes = raster_->bytes();
  statistics.seconds.visibility += watch.lap();
  ++statistics.gpu.passes;
  statistics.gpu.synchronisations += grid_.grid().views.size();  // each view is read when it is drawn
  hand_over(bin_samples(grid_.grid(), grid_.weights(), samples, settings.range, options, workers_,
                        std::move(echo.image.intensity)),
            echo, statistics);
  statistics.seconds.binning += watch.lap();
}

}  // namespace sonard::render
