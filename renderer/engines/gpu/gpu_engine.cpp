// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gpu_engine.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <numeric>
#include <utility>

#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/engines/gpu/video_memory.hpp"
#include "renderer/errors.hpp"
#include "renderer/sample_grid/grid_binner.hpp"
#include "renderer/scene/coplanar_facets.hpp"
#include "renderer/scene/refracted_world.hpp"
#include "renderer/stopwatch.hpp"
#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

namespace {

/// The world for drawing: with refraction, facets are small enough to bend with the rays; otherwise many
/// facets in one plane become a few large ones.
/// @param merged_facets number of facets removed
World drawn_world(const World& world, const RendererOptions& options, std::uint64_t& merged_facets) {
  if (options.ray_curvature_per_m != 0.0) {
    return refractable(world, options.ray_curvature_per_m);
  }
  World drawn = world;
  if (!options.skip.on(SkipRule::coplanar_facets)) {
    return drawn;
  }
  std::map<const TriangleMesh*, std::shared_ptr<const TriangleMesh>> merged;
  for (Body& body : drawn.bodies) {
    for (BodyPart& part : body.parts) {
      if (part.mesh->normals.empty()) {
        std::shared_ptr<const TriangleMesh>& mesh = merged[part.mesh.get()];
        if (!mesh) {
          mesh = std::make_shared<const TriangleMesh>(merge_coplanar_facets(*part.mesh));
        }
        merged_facets += part.mesh->triangle_count() - mesh->triangle_count();
        part.mesh = mesh;
      }
    }
  }
  return drawn;
}

}  // namespace

GpuEngine::GpuEngine(const World& world, WorkerPool& workers, const RendererOptions& options)
    : skip_(options.skip),
      largest_response_(largest_response(world)),
      workers_(workers),
      images_until_lost_(options.gpu.lose_context_at_image),
      thin_things_(world),
      sampler_(drawn_world(world, options, merged_facets_), options.gpu),
      refinement_(sampler_, thin_things_) {
  binner(0);  // the constructor must fail if OpenGL cannot build the shaders
}

GpuEngine::~GpuEngine() {
  sampler_.make_current_if_alive();
}

void GpuEngine::set_body_pose(std::size_t body, const Pose& T_world_body) {
  sampler_.set_body_pose(body, T_world_body);
  thin_things_.set_body_pose(body, T_world_body);
}

void GpuEngine::set_part_meshes(std::span<const PartMesh> changes) {
  sampler_.set_part_meshes(changes);
}

void GpuEngine::set_refraction(double bend_per_m) {
  sampler_.set_refraction(bend_per_m);
}

/// An image in progress.
struct GpuEngine::Making {
  const EchoJob& job;
  const BinningOptions options;
  GpuBinner& binner;
  std::unique_ptr<BeamRefinement::Ping> ping{};  ///< null: only the image is pending
};

void GpuEngine::images(std::span<const EchoJob> jobs) {
  for (std::size_t done = 0; done < jobs.size(); done += BeamRefinement::most_pings) {
    images_together(jobs.subspan(done, std::min(BeamRefinement::most_pings, jobs.size() - done)));
  }
}

GpuBinner& GpuEngine::binner(std::size_t number) {
  while (binners_.size() <= number) {
    binners_.push_back(std::make_unique<GpuBinner>(sampler_, binners_.empty() ? nullptr : binners_[0].get()));
  }
  return *binners_[number];
}

void GpuEngine::images_together(std::span<const EchoJob> jobs) {
  std::vector<Making> all;
  all.reserve(jobs.size());
  for (const EchoJob& job : jobs) {
    all.push_back({job, binning_options(job.request, skip_, largest_response_), binner(all.size())});
    count(job.statistics, [&] { begin(all.back()); });
  }
  // While the estimates of one image are read back, the GPU works on passes of the others.
  const auto in_the_making = [](const Making& image) { return image.ping != nullptr; };
  while (std::any_of(all.begin(), all.end(), in_the_making)) {
    for (Making& image : all) {
      count(image.job.statistics, [&] { advance(image); });
    }
  }
  for (Making& image : all) {
    count(image.job.statistics, [&] { finish(image); });
  }
}

/// Runs a step of an image and adds its costs to the statistics.
template <class Step>
void GpuEngine::count(PingStatistics& statistics, Step step) {
  Stopwatch watch;
  const double drawing_before_s = statistics.visibility_s;
  const std::uint64_t uploaded_before = sampler_.video_memory().bytes_uploaded();
  const RasterSampler::Drawn before = sampler_.drawn();
  step();
  statistics.binning_s += watch.lap() - (statistics.visibility_s - drawing_before_s);
  const RasterSampler::Drawn& now = sampler_.drawn();
  statistics.views += now.views - before.views;
  statistics.pixels += now.pixels - before.pixels;
  statistics.draw_calls += now.draw_calls - before.draw_calls;
  statistics.triangles += now.triangles - before.triangles;
  statistics.preparing_s += now.culling_s - before.culling_s;
  statistics.bytes_uploaded += sampler_.video_memory().bytes_uploaded() - uploaded_before;
  statistics.video_memory_bytes = sampler_.video_memory().bytes();
}

/// Gives the first pass to the GPU.
void GpuEngine::begin(Making& image) {
  const auto& [request, echo, statistics] = image.job;
  statistics.skipped.add(SkipRule::coplanar_facets, merged_facets_);
  if (image.options.cone_aperture != nullptr) {
    image_by_cones(request, image.options, echo, statistics);
    return;
  }
  if (images_until_lost_ > 0 && --images_until_lost_ == 0) {
    sampler_.current_context().lose();
  }
  const SonarSettings& settings = request.settings;
  const bool is_grid = needs_grid(settings);
  const bool may_pair = !is_grid && skip_.on(SkipRule::coplanar_samples);
  image.binner.begin({settings.aperture.beam_count(), settings.range, image.options, request.line_weight,
                      most_estimated_error(settings.sampling.preset),
                      may_pair ? paired_rows(settings.aperture) : 0});
  const bool may_keep = skip_.on(SkipRule::unchanged_settings);
  if (is_grid) {
    draw_grid(image.binner, request, may_keep, statistics);
    image.binner.ask_image();
  } else {
    image.ping =
        refinement_.begin(image.binner, request, surface_model(settings, skip_), may_keep, statistics);
  }
}

void GpuEngine::advance(Making& image) {
  if (image.ping && !image.ping->advance()) {
    image.binner.ask_image();
    image.ping.reset();
  }
}

void GpuEngine::finish(Making& image) {
  if (image.options.cone_aperture != nullptr) {
    return;
  }
  const auto& [request, echo, statistics] = image.job;
  hand_over(image.binner.take_image(std::move(echo.image.intensity)), echo, statistics);
  const GpuBinner::Traffic& traffic = image.binner.traffic();
  statistics.bytes_read_back += traffic.bytes_read;
  statistics.synchronisations += traffic.synchronisations;
  statistics.bytes_uploaded += traffic.bytes_uploaded;
  statistics.atomic_additions += traffic.atomic_additions;
}

void GpuEngine::draw_grid(GpuBinner& binner, const EchoRequest& request, bool may_keep,
                          PingStatistics& statistics) {
  const int beams = request.settings.aperture.beam_count();
  const int beams_per_page = binner.beams_per_page();
  if (grid_.prepare(request.settings, may_keep) && grid_page_ == beams_per_page) {
    statistics.skipped.add(SkipRule::unchanged_settings);
  } else {
    grid_page_ = 0;  // invalid until the whole grid is loaded
    grid_on_gpu_.clear();
    for (int begin = 0; begin < beams; begin += beams_per_page) {
      const int end = std::min(begin + beams_per_page, beams);
      std::vector<int> in_image(static_cast<std::size_t>(end - begin));
      std::iota(in_image.begin(), in_image.end(), begin);
      grid_on_gpu_.push_back(binner.load(part_of(grid_.grid(), begin, end), in_image));
    }
    grid_page_ = beams_per_page;
  }
  Stopwatch watch;
  const unsigned samples =
      sampler_.draw(request.T_world_sonar, grid_.grid(), surface_model(request.settings, skip_),
                    request.settings.range.sampled_range_m());
  statistics.visibility_s += watch.lap();
  for (const auto& page : grid_on_gpu_) {
    binner.add(*page, samples);
  }
  ++statistics.passes;
}

/// Makes an image with conical beams, the only kind whose samples are read back.
void GpuEngine::image_by_cones(const EchoRequest& request, const BinningOptions& options, MeanEcho& echo,
                               PingStatistics& statistics) {
  constexpr int views = 3;
  constexpr int columns = 512;
  constexpr int rows = 512;
  SonarSettings settings = request.settings;
  if (!needs_grid(settings)) {
    // Refinement of single beams would miss samples of neighbouring azimuths that belong to these beams.
    settings.sampling = Sampling::of_grid(views, columns, rows);
  }
  Stopwatch watch;
  if (cone_grid_.prepare(settings, skip_.on(SkipRule::unchanged_settings))) {
    statistics.skipped.add(SkipRule::unchanged_settings);
  }
  const auto samples = sampler_.sample(request.T_world_sonar, cone_grid_.grid(),
                                       surface_model(settings, skip_), settings.range.sampled_range_m());
  statistics.visibility_s += watch.lap();
  ++statistics.passes;
  hand_over(bin_echoes(cone_grid_.grid(), cone_grid_.weights(), samples, settings.range, options, workers_,
                       std::move(echo.image.intensity)),
            echo, statistics);
}

}  // namespace sonard::render
