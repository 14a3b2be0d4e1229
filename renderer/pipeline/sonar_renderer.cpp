#include "renderer/pipeline/sonar_renderer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <unordered_map>

#include "renderer/acoustics/echo_reception.hpp"
#include "renderer/acoustics/propagation_loss.hpp"
#include "renderer/acoustics/receiver.hpp"
#include "renderer/acoustics/volume_reverberation.hpp"
#include "renderer/binning/echo_binner.hpp"
#include "renderer/binning/gpu_binner.hpp"
#include "renderer/multipath/multipath.hpp"
#include "renderer/pipeline/echo_cache.hpp"
#include "renderer/pipeline/ping_motion.hpp"
#include "renderer/visibility/beam_refinement.hpp"
#include "renderer/visibility/bent_world.hpp"
#include "renderer/visibility/ray_bend.hpp"
#include "renderer/visibility/sample_grid.hpp"
#include "renderer/visibility/sampler_choice.hpp"
#include "renderer/visibility/slices/slice_sampler.hpp"
#include "renderer/visibility/terrain_levels.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

namespace {

constexpr int most_native_lines = 65535;  // multibeam heads count them in 16 bits
constexpr int most_beams = 4096;
constexpr double shortest_line_m = 1e-6;
constexpr double longest_range_m = 1e5;

/// Surfaces a little beyond the last line are still sampled, so that footprints which cross it are complete.
double sampled_range_m(const SonarSettings& settings) {
  return settings.range.max_range_m() * 1.05;
}

void check(const SonarSettings& settings) {
  check_aperture(settings.aperture);
  const RangeLines& range = settings.range;
  if (range.count < 1 || range.count > most_native_lines) {
    throw RequestError("range: " + std::to_string(range.count) + " lines, expected 1 to " +
                       std::to_string(most_native_lines));
  }
  if (!(range.step_m >= shortest_line_m) || !(range.max_range_m() <= longest_range_m)) {
    throw RequestError("range: a line of " + std::to_string(range.step_m) + " m gives no usable range");
  }
  if (settings.sixteen_bit && settings.output_scale != OutputScale::linear) {
    throw RequestError("output: samples of 16 bits are linear, a scale of half decibels has 8 bits");
  }
  if (range.compression_log2 < 0 || range.compression_log2 > 4) {
    throw RequestError("range: compression 2^" + std::to_string(range.compression_log2) +
                       ", expected 2^0 to 2^4");
  }
  if (settings.aperture.beam_count() > most_beams) {
    throw RequestError("aperture: more than " + std::to_string(most_beams) + " beams");
  }
}

/// The pose with a unit quaternion.
Pose checked(const Pose& pose) {
  const double norm = glm::length(pose.orientation);
  const glm::dvec3& p = pose.position_m;
  if (!std::isfinite(norm) || !(std::abs(norm - 1) < 1e-3) || !std::isfinite(p.x + p.y + p.z)) {
    throw RequestError("pose: not finite, or its quaternion is not of unit length");
  }
  return {p, pose.orientation / norm};
}

SurfaceModel surface_model(const SonarSettings& settings, const SkipSwitches& skip) {
  SurfaceModel surface;
  surface.model = settings.model;
  if (settings.model == Model::physical &&
      settings.physical.backscatter == PhysicalModel::Backscatter::lambert_facet) {
    surface.facets = skip.on(SkipRule::facet_kernel) ? Facets::near_normal : Facets::everywhere;
  }
  if (settings.model == Model::paper) {
    surface.sigmoid_slope = settings.paper.sigmoid_slope;
    surface.sigmoid_centre = settings.paper.sigmoid_centre;
    surface.attenuation_per_m = settings.paper.attenuation_per_m;
    surface.two_sided = settings.paper.two_sided;
  }
  return surface;
}

/// Of all surfaces of a world, in either model: mu <= 1/pi, and the sigmoid is at most 1.
float largest_response(const World& world) {
  float largest = 1.0F;
  for (const Body& body : world.bodies) {
    for (const BodyPart& part : body.parts) {
      largest = std::max(largest, Backscatter(part.material).largest_response());
    }
  }
  return largest;
}

/// Whether the beams are cones around a straight array.
bool hears_cones(const SonarSettings& settings) {
  return is_heard_by_array(settings) && settings.aperture.bearing == Aperture::Bearing::conical;
}

BinningOptions binning_options(const SonarSettings& settings, const SkipSwitches& skip,
                               float largest_response) {
  BinningOptions options;
  options.skip = skip;
  options.open_water =
      has_volume_reverberation(settings) && !(is_clear_water(settings) && skip.on(SkipRule::clear_water));
  options.largest_response = largest_response;
  options.footprint = settings.sampling.footprint;
  if (settings.model == Model::paper) {
    options.mean = true;
    options.footprint = options.footprint && settings.paper.footprint;
    options.legacy_bin_index = settings.paper.legacy_bin_index && !options.footprint;
  }
  options.cone_aperture = hears_cones(settings) ? &settings.aperture : nullptr;
  return options;
}

class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

SliceAccuracy slice_accuracy(const SonarSettings& settings) {
  // The paper's sigmoid makes more of small changes of incidence.
  const int slices = settings.model == Model::paper ? 2 : 1;
  switch (settings.sampling.preset) {
    case Sampling::Preset::fast:
      return {slices, 25, true, 2.5e-2F, 1.0F, 3e-3F, 0.15F, 0.05F, 4.0F, 0.5F, 0.03F};
    case Sampling::Preset::reference:
      return {9, 125, false, 1e-4F, 0.02F, 5e-5F, 0.005F, 0.001F, 2.0F, 0.03F, 0.001F};
    default:
      return {.slices_per_beam = slices};
  }
}

/// Null: samples are binned on the CPU. Adds to what the sampler says of itself.
std::unique_ptr<GpuBinner> make_gpu_binner(GpuBinning wanted, ChosenSampler& chosen) {
  const bool hardware = !is_software_gl(chosen.description);
  if (chosen.raster == nullptr || wanted == GpuBinning::off ||
      (wanted == GpuBinning::automatic && !hardware)) {
    return nullptr;
  }
  try {
    auto binner = std::make_unique<GpuBinner>(*chosen.raster);
    chosen.description += "; fixed grids are binned by it too";
    return binner;
  } catch (const RendererError& error) {
    if (wanted == GpuBinning::on) {
      throw;
    }
    chosen.description += std::string("; it cannot bin: ") + error.what();
    return nullptr;
  }
}

}  // namespace

struct SonarRenderer::Impl {
  const SkipSwitches skip;
  const float largest_response;
  WorkerPool workers;  // outlives whoever uses it
  SpatialIndex index;  // where the world is moved
  std::unique_ptr<SpatialIndex>
      bendable_index;  // of the same world in facets that bend; null: rays are straight
  ChosenSampler chosen;
  std::unique_ptr<GpuBinner> gpu_binner;  // null: all binning is the CPU's
  std::unique_ptr<SliceSampler> slices;   // of the backend `ray`
  BeamRefinement refinement;              // of the backend `raster`
  Multipath multipath;
  TerrainLevels terrain;
  Receiver receiver;
  PingStatistics statistics;
  const double ray_curvature_per_m;
  std::unordered_map<std::string, std::size_t> body_number;
  std::uint64_t world_revision = 1;         // counts the moves of bodies
  std::map<int, CachedEcho> cached_echoes;  // by stream
  std::map<int, EchoReception> receptions;  // by stream
  EchoImage fine_echo;                      // memory

  Impl(const World& world, const RendererOptions& options)
      : skip(options.skip),
        largest_response(render::largest_response(world)),
        workers(options.threads),
        index(world, workers),
        bendable_index(
            options.ray_curvature_per_m == 0.0
                ? nullptr
                : std::make_unique<SpatialIndex>(bendable(world, options.ray_curvature_per_m), workers)),
        chosen(choose_sampler(visible(), options.backend, workers)),
        gpu_binner(make_gpu_binner(options.gpu_binning, chosen)),
        refinement(*chosen.sampler, workers),
        multipath(index, workers, options.skip),
        terrain(
            world, options.skip,
            options.ray_curvature_per_m == 0.0 ? 0.0F : bendable_edge_m(world, options.ray_curvature_per_m)),
        receiver(options.skip),
        ray_curvature_per_m(options.ray_curvature_per_m) {
    for (std::size_t body = 0; body < world.bodies.size(); ++body) {
      body_number[world.bodies[body].name] = body;
    }
    if (chosen.backend == Backend::ray) {
      slices = std::make_unique<SliceSampler>(visible().world(), workers, slice_switches(options));
    }
  }

  /// Of the surfaces that may bend with the rays.
  SpatialIndex& visible() { return bendable_index ? *bendable_index : index; }

  /// Facets that were divided so that they bend with the rays are not to be merged again.
  static SkipSwitches slice_switches(const RendererOptions& options) {
    SkipSwitches switches = options.skip;
    return options.ray_curvature_per_m == 0.0 ? switches : switches.turn_off(SkipRule::coplanar_facets);
  }

  /// SkipRule::motion_within_ping. @throws RequestError
  SonarMotion motion_of(const PingRequest& request) {
    SonarMotion motion{checked(request.T_world_sonar), std::nullopt};
    const SonarSettings& settings = request.settings;
    if (!request.T_world_sonar_at_end || settings.model != Model::physical ||
        !settings.physical.motion_within_ping) {
      return motion;
    }
    const Pose at_end = checked(*request.T_world_sonar_at_end);
    if (at_end == motion.T_world_sonar) {
      return motion;
    }
    if (skip.on(SkipRule::motion_within_ping) && !turns_beams(turn_between_rad(motion.T_world_sonar, at_end),
                                                              settings.aperture.receive_beamwidth_rad)) {
      statistics.skipped.add(SkipRule::motion_within_ping);
      return motion;
    }
    motion.at_end = at_end;
    return motion;
  }

  /// SkipRule::straight_rays.
  void bend_rays(const SonarSettings& settings) {
    double bend_per_m = settings.model == Model::physical ? ray_curvature_per_m / 2 : 0.0;
    if (bend_per_m != 0.0 && skip.on(SkipRule::straight_rays) &&
        !bends_beams(bend_per_m, settings.range.max_range_m(), settings.aperture.vertical_beamwidth_rad)) {
      statistics.skipped.add(SkipRule::straight_rays);
      bend_per_m = 0.0;
    }
    chosen.sampler->set_ray_bend(bend_per_m);
    if (slices) {
      slices->set_ray_bend(bend_per_m);
    }
  }

  /// @param settings_and_seed of which the pose is not looked at
  void render_echo(const PingRequest& settings_and_seed, int stream, const SonarMotion& motion,
                   EchoImage& image) {
    const SonarSettings& settings = settings_and_seed.settings;
    image.beams = settings.aperture.beam_count();
    image.lines = settings.range.count;
    if (!settings.transmit) {
      image.intensity.assign(static_cast<std::size_t>(image.beams) * static_cast<std::size_t>(image.lines),
                             0.0F);
      return;
    }
    EchoReception& reception = receptions[stream];
    reception.prepare(settings, settings_and_seed.seed, stream, skip, statistics.skipped);
    if (reception.has_pattern()) {
      sample_echo(EchoReception::sampled(settings), motion, fine_echo);
      Stopwatch watch;
      reception.hear(fine_echo, image, workers, skip, statistics.skipped);
      statistics.azimuth_pattern_s = watch.lap();
    } else {
      sample_echo(settings, motion, image);
    }
    Stopwatch watch;
    reception.spread(image, workers);
    statistics.pulse_s = watch.lap();
  }

  /// The echo as it comes to the sonar.
  void sample_echo(const SonarSettings& settings, const SonarMotion& motion, EchoImage& image) {
    image.beams = settings.aperture.beam_count();
    image.lines = settings.range.count;
    static const std::vector<float> no_loss;
    const std::vector<float>& line_weight =
        settings.model == Model::physical ? loss_for(settings).of_line : no_loss;
    bend_rays(settings);
    follow_terrain(settings, motion);
    const Summing summing{line_weight, binning_options(settings, skip, largest_response)};
    BinningResult bins = motion.at_end
                             ? look_in_spans(settings, motion, summing, std::move(image.intensity))
                             : look(settings, motion.T_world_sonar, summing, std::move(image.intensity));
    image.intensity = std::move(bins.echo);
    Stopwatch watch;
    multipath.add_to(image.intensity, settings, motion.T_world_sonar, statistics.skipped);
    statistics.multipath_s = watch.lap();
    if (settings.model == Model::physical) {
      add_volume_reverberation(bins.open_sr, settings, image);
      if (has_volume_reverberation(settings) && bins.open_sr.empty()) {
        statistics.skipped.add(SkipRule::clear_water);
      }
      apply_loss(line_weight, image);
    }
    statistics.binning_s += watch.lap();
  }

  /// SkipRule::terrain_detail. Motion within a ping changes no detail, but it reaches further.
  void follow_terrain(const SonarSettings& settings, const SonarMotion& motion) {
    Stopwatch watch;
    const glm::dvec3& start_m = motion.T_world_sonar.position_m;
    const double way_m = motion.at_end ? glm::length(motion.at_end->position_m - start_m) : 0.0;
    const std::vector<PartMesh> changes =
        terrain.look({start_m, sampled_range_m(settings) + way_m, settings.range.step_m}, index.world(),
                     workers, statistics.skipped);
    if (!changes.empty()) {
      chosen.sampler->set_part_meshes(changes);
      if (slices) {
        slices->set_part_meshes(changes);
      }
      index.set_part_meshes(changes);
      if (bendable_index) {
        bendable_index->set_part_meshes(changes);
      }
    }
    statistics.visibility_s += watch.lap();
  }

  /// How what is seen becomes an image; the same in all looks of a ping.
  struct Summing {
    const std::vector<float>& line_weight;  ///< what lines are yet to be multiplied with; empty: 1
    BinningOptions options;
  };

  /// Every line from the pose of its span. Nothing is blended, so a line is heard whole, and once.
  BinningResult look_in_spans(const SonarSettings& settings, const SonarMotion& motion,
                              const Summing& summing, std::vector<float> memory) {
    BinningResult joined;
    joined.beams = settings.aperture.beam_count();
    joined.lines = settings.range.count;
    joined.echo = std::move(memory);
    joined.echo.resize(static_cast<std::size_t>(joined.beams) * static_cast<std::size_t>(joined.lines));
    joined.open_sr.resize(summing.options.open_water ? joined.echo.size() : 0);
    SonarSettings up_to_end = settings;
    BinningResult bins;
    for (const RangeSpan& span : range_spans(motion.T_world_sonar, *motion.at_end, settings.range.count,
                                             settings.aperture.receive_beamwidth_rad)) {
      up_to_end.range.count = span.end_line;
      bins = look(up_to_end, span.T_world_sonar, summing, std::move(bins.echo));
      copy_lines(bins.echo, span, joined.beams, joined.echo);
      copy_lines(bins.open_sr, span, joined.beams, joined.open_sr);
    }
    return joined;
  }

  /// From an image that ends with the span.
  static void copy_lines(const std::vector<float>& from, const RangeSpan& span, int beams,
                         std::vector<float>& to) {
    const std::size_t lines_from = from.size() / static_cast<std::size_t>(beams);
    const std::size_t lines_to = to.size() / static_cast<std::size_t>(beams);
    for (std::size_t beam = 0; beam < static_cast<std::size_t>(beams) && lines_from > 0; ++beam) {
      const auto first = static_cast<std::size_t>(span.first_line);
      std::copy(&from[beam * lines_from] + first, &from[beam * lines_from] + lines_from,
                &to[beam * lines_to] + first);
    }
  }

  /// Finds what is visible and bins it; adds to the statistics of both.
  /// @param memory for the result
  BinningResult look(const SonarSettings& settings, const Pose& T_world_sonar, const Summing& summing,
                     std::vector<float> memory) {
    if (needs_grid(settings)) {
      return look_with_grid(T_world_sonar, settings, summing, std::move(memory));
    }
    if (!slices && hears_cones(settings)) {
      // Beams that are sampled again by themselves would miss what their neighbours saw for them.
      constexpr int views = 3;
      constexpr int columns = 512;
      constexpr int rows = 512;
      SonarSettings even = settings;
      even.sampling = Sampling::of_grid(views, columns, rows);
      return look_with_grid(T_world_sonar, even, summing, std::move(memory));
    }
    return slices ? look_in_slices(T_world_sonar, settings, summing, std::move(memory))
                  : look_until_close(T_world_sonar, settings, summing);
  }

  BinningResult look_with_grid(const Pose& T_world_sonar, const SonarSettings& settings,
                               const Summing& summing, std::vector<float> memory) {
    Stopwatch watch;
    const SampleGrid& samples = grid_for(settings);
    const SurfaceModel surface = surface_model(settings, skip);
    if (gpu_binner && summing.options.cone_aperture == nullptr) {
      statistics.gpu_binning_obstacle = gpu_binner->make_room(settings.range.count, summing.options);
      if (statistics.gpu_binning_obstacle.empty()) {
        const auto textures = chosen.raster->draw(T_world_sonar, samples, surface, sampled_range_m(settings));
        statistics.visibility_s += watch.lap();
        return counted(gpu_binner->bin(textures, settings.range, summing.options, std::move(memory)), watch);
      }
    }
    const auto views = chosen.sampler->sample(T_world_sonar, samples, surface, sampled_range_m(settings));
    statistics.visibility_s += watch.lap();
    return counted(bin_echoes(samples, views, settings.range, summing.options, workers, std::move(memory)),
                   watch);
  }

  BinningResult look_in_slices(const Pose& T_world_sonar, const SonarSettings& settings,
                               const Summing& summing, std::vector<float> memory) {
    Stopwatch watch;
    const auto cells =
        slices->sample(T_world_sonar, settings.aperture, settings.range, sampled_range_m(settings),
                       surface_model(settings, skip), slice_accuracy(settings));
    statistics.visibility_s += watch.lap();
    statistics.skipped += slices->skipped();
    return counted(
        bin_echoes(cells, settings.aperture, settings.range, summing.options, workers, std::move(memory)),
        watch);
  }

  /// Adds what binning has counted and taken to the statistics.
  BinningResult counted(BinningResult bins, Stopwatch& watch) {
    statistics.skipped += bins.skipped;
    statistics.binning_s += watch.lap();
    statistics.samples += bins.samples;
    statistics.invalid_samples += bins.invalid_samples;
    statistics.saturated_samples += bins.saturated_samples;
    return bins;
  }

  BinningResult look_until_close(const Pose& T_world_sonar, const SonarSettings& settings,
                                 const Summing& summing) {
    Stopwatch watch;
    const SurfaceModel surface = surface_model(settings, skip);
    BeamRefinement::Result found = refinement.look(
        {T_world_sonar, settings, surface, sampled_range_m(settings), summing.options, summing.line_weight},
        skip.on(SkipRule::unchanged_settings));
    if (found.known_grid) {
      statistics.skipped.add(SkipRule::unchanged_settings);
    }
    BinningResult bins = counted(std::move(found.bins), watch);
    statistics.visibility_s += found.visibility_s;
    statistics.binning_s -= found.visibility_s;
    return bins;
  }

  /// Grids cost more to make than a ping: the last one is kept for as long as the same aperture is asked for.
  const SampleGrid& grid_for(const SonarSettings& settings) {
    const GridOptions options = grid_options(settings);
    const bool same = grid_key && same_grid(*grid_key, settings) && made_with == options;
    if (same && skip.on(SkipRule::unchanged_settings)) {
      statistics.skipped.add(SkipRule::unchanged_settings);
    } else {
      grid_key.reset();
      grid = make_sample_grid(settings.aperture, settings.sampling, options);
      grid_key = settings;
      made_with = options;
      if (gpu_binner) {
        gpu_binner->set_grid(grid);
      }
    }
    return grid;
  }

  const PropagationLoss& loss_for(const SonarSettings& settings) {
    if (loss.fits(settings) && skip.on(SkipRule::unchanged_settings)) {
      statistics.skipped.add(SkipRule::unchanged_settings);
    } else {
      loss = PropagationLoss(settings);
    }
    return loss;
  }

 private:
  static bool same_grid(const SonarSettings& a, const SonarSettings& b) {
    return a.aperture.beam_edges_rad == b.aperture.beam_edges_rad &&
           a.aperture.vertical_beamwidth_rad == b.aperture.vertical_beamwidth_rad &&
           a.aperture.elevation == b.aperture.elevation && a.sampling.views == b.sampling.views &&
           a.sampling.columns_per_view == b.sampling.columns_per_view && a.sampling.rows == b.sampling.rows;
  }

  SampleGrid grid;
  std::optional<SonarSettings> grid_key;
  GridOptions made_with;
  PropagationLoss loss;
};

SonarRenderer::SonarRenderer(const World& world, const RendererOptions& options)
    : impl_(std::make_unique<Impl>(world, options)) {}
SonarRenderer::~SonarRenderer() = default;

Backend SonarRenderer::backend() const {
  return impl_->chosen.backend;
}

const std::string& SonarRenderer::backend_description() const {
  return impl_->chosen.description;
}

bool SonarRenderer::set_body_pose(const std::string& body_name, const Pose& T_world_body) {
  const Pose pose = checked(T_world_body);
  const auto known = impl_->body_number.find(body_name);
  if (known == impl_->body_number.end()) {
    return false;
  }
  const std::size_t body = known->second;
  if (impl_->index.world().bodies[body].T_world_body == pose) {
    return true;  // publishers repeat the poses of bodies that rest
  }
  ++impl_->world_revision;
  if (impl_->slices) {
    impl_->slices->set_body_pose(body, pose);
  }
  impl_->index.set_body_pose(body, pose);
  if (impl_->bendable_index) {
    impl_->bendable_index->set_body_pose(body, pose);
  }
  impl_->chosen.sampler->set_body_pose(body, pose);
  return true;
}

const EchoImage& SonarRenderer::render_echo(const PingRequest& request, int stream) {
  check(request.settings);
  impl_->statistics = {};
  const SonarMotion motion = impl_->motion_of(request);
  CachedEcho& cached = impl_->cached_echoes[stream];
  if (impl_->skip.on(SkipRule::unchanged_scene) && cached.fits(request, motion, impl_->world_revision)) {
    impl_->statistics.skipped.add(SkipRule::unchanged_scene);
    return cached.image;
  }
  cached.world_revision = 0;  // until all of it is there
  impl_->render_echo(request, stream, motion, cached.image);
  cached.settings = request.settings;
  cached.seed = request.seed;
  cached.motion = motion;
  cached.world_revision = impl_->world_revision;
  return cached.image;
}

PingSamples SonarRenderer::render_ping(const PingRequest& request, int stream) {
  const EchoImage& echo = render_echo(request, stream);
  Stopwatch watch;
  PingSamples samples = impl_->receiver.receive(echo, request, stream, impl_->workers);
  impl_->statistics.receiver_s = watch.lap();
  impl_->statistics.skipped += impl_->receiver.skipped();
  return samples;
}

bool SonarRenderer::pass_ping(const PingRequest& request, int stream) {
  check(request.settings);
  impl_->statistics = {};
  return impl_->receiver.pass(request, stream, impl_->workers);
}

const PingStatistics& SonarRenderer::last_statistics() const {
  return impl_->statistics;
}

}  // namespace sonard::render
