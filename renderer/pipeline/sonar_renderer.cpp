// SPDX-License-Identifier: Apache-2.0
#include "renderer/pipeline/sonar_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>

#include "renderer/acoustics/point_spread.hpp"
#include "renderer/acoustics/receiver.hpp"
#include "renderer/acoustics/surface_share.hpp"
#include "renderer/acoustics/transmission_loss.hpp"
#include "renderer/acoustics/volume_reverberation.hpp"
#include "renderer/acoustics/water_clutter.hpp"
#include "renderer/engines/engine_switch.hpp"
#include "renderer/multipath/multipath.hpp"
#include "renderer/pipeline/echo_cache.hpp"
#include "renderer/pipeline/ping_motion.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/scene/refracted_world.hpp"
#include "renderer/scene/refraction.hpp"
#include "renderer/scene/terrain_levels.hpp"
#include "renderer/spatial_index/spatial_index.hpp"
#include "renderer/stopwatch.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

namespace {

constexpr int most_range_bins = 65535;  // multibeam sonars count them in 16 bits
constexpr int most_beams = 4096;
constexpr double shortest_line_m = 1e-6;
constexpr double longest_range_m = 1e5;

void check(const SonarSettings& settings) {
  check_aperture(settings.aperture);
  if (settings.directions.any()) {
    check_directions(settings.directions);
    if (needs_grid(settings) || settings.model != Model::physical) {
      throw RequestError("directions: expected a preset in place of a grid of samples, and mode physical");
    }
  }
  const RangeBins& range = settings.range;
  if (range.count < 1 || range.count > most_range_bins) {
    throw RequestError("range: " + std::to_string(range.count) + " lines, expected 1 to " +
                       std::to_string(most_range_bins));
  }
  if (!(range.step_m >= shortest_line_m) || !(range.max_range_m() <= longest_range_m)) {
    throw RequestError("range: a line of " + std::to_string(range.step_m) + " m gives no usable range");
  }
  if (settings.sixteen_bit && settings.output_scale == OutputScale::half_decibels) {
    throw RequestError("output: a scale of half decibels has 8 bits, not 16");
  }
  if (!(settings.output_exponent > 0 && std::isfinite(settings.output_exponent))) {
    throw RequestError("output: an amplitude to the power of " + std::to_string(settings.output_exponent) +
                       ", expected more than 0");
  }
  if (!(settings.output_full_scale > 0 && std::isfinite(settings.output_full_scale))) {
    throw RequestError("output: a full scale of " + std::to_string(settings.output_full_scale) +
                       ", expected more than 0");
  }
  if (range.compression_log2 < 0 || range.compression_log2 > 4) {
    throw RequestError("range: compression 2^" + std::to_string(range.compression_log2) +
                       ", expected 2^0 to 2^4");
  }
  if (settings.aperture.beam_count() > most_beams) {
    throw RequestError("aperture: more than " + std::to_string(most_beams) + " beams");
  }
}

/// The pose with a normalised quaternion. @throws RequestError
Pose checked(const Pose& pose) {
  const double norm = glm::length(pose.orientation);
  const glm::dvec3& p = pose.position_m;
  if (!std::isfinite(norm) || !(std::abs(norm - 1) < 1e-3) || !std::isfinite(p.x + p.y + p.z)) {
    throw RequestError("pose: not finite, or its quaternion is not of unit length");
  }
  return {p, pose.orientation / norm};
}

}  // namespace

struct SonarRenderer::Impl {
  /// A ping whose mean echo the engine has computed in advance.
  struct Begun {
    CachedEcho made_of;  // without an image
    SonarSettings sampled;
    MeanEcho echo{};
    PingStatistics statistics{};
  };

  const SkipSwitches skip;
  const double ray_curvature_per_m;
  WorkerPool workers;  // must outlive its users
  SpatialIndex index;  // the world with the present poses
  EngineSwitch engine;
  Multipath multipath;
  TerrainLevels terrain;
  Receiver receiver;
  std::map<int, TransmissionLoss> losses;  // by head
  PingStatistics statistics;
  std::unordered_map<std::string, std::size_t> body_number;
  std::uint64_t world_revision = 1;          // counts the moves of bodies
  std::map<int, CachedEcho> cached_echoes;   // by head
  std::map<int, PointSpread> point_spreads;  // by head
  std::map<int, Begun> begun;                // by head
  EchoImage fine_echo;                       // memory
  // The strongest echo of each line, before the pulse; empty without echoes of the water.
  std::vector<float> strongest_of_surfaces, strongest_of_all;

  Impl(const World& world, const RendererOptions& options)
      : skip(options.skip),
        ray_curvature_per_m(options.ray_curvature_per_m),
        workers(options.threads),
        index(world, workers),
        engine(index, workers, options),
        multipath(index, workers, options.skip),
        terrain(world, options.skip,
                ray_curvature_per_m == 0.0 ? 0.0F : refractable_edge_m(world, ray_curvature_per_m)),
        receiver(options.skip) {
    for (std::size_t body = 0; body < world.bodies.size(); ++body) {
      body_number[world.bodies[body].name] = body;
    }
  }

  void set_body_pose(std::size_t body, const Pose& T_world_body) {
    if (index.world().bodies[body].T_world_body == T_world_body) {
      return;  // publishers repeat the poses of bodies at rest
    }
    index.set_body_pose(body, T_world_body);
    engine.set_body_pose(body, T_world_body);
    ++world_revision;
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

  /// Sets the refraction of the engine (SkipRule::straight_rays).
  void bend_rays(const SonarSettings& settings) {
    double bend_per_m = settings.model == Model::physical ? ray_curvature_per_m / 2 : 0.0;
    if (bend_per_m != 0.0 && skip.on(SkipRule::straight_rays) &&
        !refraction_matters(bend_per_m, settings.range.max_range_m(),
                            settings.aperture.vertical_beamwidth_rad)) {
      statistics.skipped.add(SkipRule::straight_rays);
      bend_per_m = 0.0;
    }
    engine.set_refraction(bend_per_m);
  }

  /// @param settings_and_seed its poses are not used
  void render_echo(const PingRequest& settings_and_seed, int head, const SonarMotion& motion,
                   EchoImage& image) {
    const SonarSettings& settings = settings_and_seed.settings;
    image.beams = settings.aperture.beam_count();
    image.bins = settings.range.count;
    image.steady = {};
    image.surface_share.clear();
    strongest_of_all.clear();
    if (!settings.transmit) {
      image.intensity.assign(static_cast<std::size_t>(image.beams) * static_cast<std::size_t>(image.bins),
                             0.0F);
      return;
    }
    PointSpread& point_spread = point_spreads[head];
    point_spread.prepare(settings, settings_and_seed.seed, head, skip, statistics.skipped);
    if (point_spread.has_pattern()) {
      sample_echo(PointSpread::sampled(settings), settings_and_seed.seed, head, motion, fine_echo);
      Stopwatch watch;
      point_spread.form_beams(fine_echo, settings, image, workers, skip, statistics.skipped);
      statistics.seconds.azimuth_pattern = watch.lap();
    } else {
      sample_echo(settings, settings_and_seed.seed, head, motion, image);
    }
    Stopwatch watch;
    point_spread.spread(image, workers);
    if (!strongest_of_all.empty()) {
      point_spread.spread_lines(strongest_of_surfaces, workers);
      point_spread.spread_lines(strongest_of_all, workers);
      divide(strongest_of_surfaces, strongest_of_all);
      image.surface_share = strongest_of_surfaces;
    }
    statistics.seconds.pulse = watch.lap();
  }

  /// The strongest echoes of surfaces by direction. Neither the water nor mirrors add to them.
  void render_directions(const PingRequest& request, int head, const Pose& T_world_sonar,
                         DirectionEchoes& directions) {
    const SonarSettings& settings = request.settings;
    if (!settings.transmit) {
      const auto pixels = static_cast<std::size_t>(settings.directions.columns * settings.directions.rows);
      directions = {settings.directions.columns, settings.directions.rows, std::vector<float>(pixels),
                    std::vector<float>(pixels)};
      return;
    }
    bend_rays(settings);
    follow_terrain(settings, {T_world_sonar, std::nullopt});
    MeanEcho echo;
    engine.image({T_world_sonar, settings, false, &loss_for(settings, head).of_line}, echo, statistics);
    directions = std::move(echo.directions);
    statistics.sees_surface =
        std::ranges::any_of(directions.intensity, [](float intensity) { return intensity > 0; });
  }

  /// The request to the engine; it refers to the settings.
  static EchoRequest engine_request(const SonarSettings& settings, const SonarMotion& motion) {
    return {motion.T_world_sonar, settings, has_volume_reverberation(settings)};
  }

  /// The echo as it arrives at the sonar.
  void sample_echo(const SonarSettings& settings, std::uint64_t seed, int head, const SonarMotion& motion,
                   EchoImage& image) {
    const EchoRequest request = engine_request(settings, motion);
    MeanEcho echo{std::move(image), {}};
    if (const auto made = begun.find(head); made != begun.end()) {
      echo = std::move(made->second.echo);
      const SkipCounts skipped = statistics.skipped;
      statistics = made->second.statistics;
      statistics.skipped += skipped;
      begun.erase(made);
    } else {
      bend_rays(settings);
      follow_terrain(settings, motion);
      if (motion.at_end) {
        image_in_spans(request, *motion.at_end, echo);
      } else {
        engine.image(request, echo, statistics);
      }
    }
    image = std::move(echo.image);
    statistics.sees_surface =
        std::ranges::any_of(image.intensity, [](float echo_of_bin) { return echo_of_bin > 0; });
    Stopwatch watch;
    multipath.add_to(image.intensity, settings, motion.T_world_sonar, statistics.skipped);
    statistics.seconds.multipath = watch.lap();
    if (settings.model == Model::physical) {
      const bool water_echoes =
          settings.physical.water_clutter.density_per_m3 > 0 || has_volume_reverberation(settings);
      if (water_echoes) {
        strongest_of_surfaces = strongest_of_lines(image, workers);
      }
      add_water_clutter(settings, motion.T_world_sonar, seed, image);
      add_volume_reverberation(echo.open_sr, settings, image);
      if (water_echoes) {
        strongest_of_all = strongest_of_lines(image, workers);
      }
      apply_loss(loss_for(settings, head).of_line, image);
    }
    statistics.seconds.binning += watch.lap();
  }

  /// SkipRule::terrain_detail. Motion within a ping extends the range, but does not change the detail.
  void follow_terrain(const SonarSettings& settings, const SonarMotion& motion) {
    Stopwatch watch;
    const glm::dvec3& start_m = motion.T_world_sonar.position_m;
    const double way_m = motion.at_end ? glm::length(motion.at_end->position_m - start_m) : 0.0;
    const std::vector<PartMesh> changes =
        terrain.refine({start_m, settings.range.sampled_range_m() + way_m, settings.range.step_m},
                       index.world(), workers, statistics.skipped);
    if (!changes.empty()) {
      index.set_part_meshes(changes);
      engine.set_part_meshes(changes);
    }
    statistics.seconds.visibility += watch.lap();
  }

  /// Renders each line from the pose of its span. Nothing is blended: a line comes from one span only.
  void image_in_spans(const EchoRequest& request, const Pose& at_end, MeanEcho& joined) {
    SonarSettings up_to_end = request.settings;
    const int beams = up_to_end.aperture.beam_count();
    const int lines = up_to_end.range.count;
    joined.image.beams = beams;
    joined.image.bins = lines;
    joined.image.intensity.resize(static_cast<std::size_t>(beams) * static_cast<std::size_t>(lines));
    joined.open_sr.resize(request.open_water ? joined.image.intensity.size() : 0);
    MeanEcho echo;
    for (const RangeSpan& span :
         range_spans(request.T_world_sonar, at_end, lines, up_to_end.aperture.receive_beamwidth_rad)) {
      up_to_end.range.count = span.end_line;
      engine.image({span.T_world_sonar, up_to_end, request.open_water}, echo, statistics);
      copy_lines(echo.image.intensity, span, beams, joined.image.intensity);
      copy_lines(echo.open_sr, span, beams, joined.open_sr);
    }
  }

  /// Copies the lines of a span from an image that ends with the span.
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

  const TransmissionLoss& loss_for(const SonarSettings& settings, int head) {
    TransmissionLoss& loss = losses[head];
    if (loss.fits(settings) && skip.on(SkipRule::unchanged_settings)) {
      statistics.skipped.add(SkipRule::unchanged_settings);
    } else {
      loss = TransmissionLoss(settings);
    }
    return loss;
  }

  /// Whether the engine has rendered this ping in advance. An advance result for another ping is dropped.
  bool is_begun(int head, const PingRequest& request, const SonarMotion& motion) {
    const auto made = begun.find(head);
    if (made != begun.end() && !made->second.made_of.fits(request, motion, world_revision)) {
      begun.erase(made);
      return false;
    }
    return made != begun.end();
  }

  /// Entry for a ping that the engine can render with others; nullptr: to be rendered alone, or not at all.
  /// @throws RequestError
  Begun* may_begin(const HeadRequest& ping) {
    const auto& [head, request] = ping;
    check(request.settings);
    const SonarMotion motion = motion_of(request);
    const bool unchanged =
        skip.on(SkipRule::unchanged_scene) && cached_echoes[head].fits(request, motion, world_revision);
    if (request.settings.directions.any() || !request.settings.transmit || motion.at_end || unchanged ||
        is_begun(head, request, motion)) {
      return nullptr;
    }
    PointSpread& spread = point_spreads[head];
    spread.prepare(request.settings, request.seed, head, skip, statistics.skipped);
    CachedEcho made_of{{}, {}, request.settings, request.seed, motion, world_revision};
    return &begun
                .emplace(head, Begun{std::move(made_of), spread.has_pattern()
                                                             ? PointSpread::sampled(request.settings)
                                                             : request.settings})
                .first->second;
  }

  void begin(std::span<const HeadRequest> pings) {
    // Terrain detail and bent rays depend on the ping, so such pings are rendered one by one.
    if (engine.kind() != EngineKind::gpu || pings.size() < 2 || terrain.any() || ray_curvature_per_m != 0.0) {
      return;
    }
    std::deque<EchoRequest> requests;  // jobs refer to them
    std::vector<EchoJob> jobs;
    std::vector<int> heads;
    statistics = {};
    for (const HeadRequest& ping : pings) {
      try {
        if (&ping == &pings.front() && is_begun(ping.head, ping.request, motion_of(ping.request))) {
          return;  // render it first; the next pings start together when all of these are done
        }
        if (Begun* made = may_begin(ping)) {
          heads.push_back(ping.head);
          requests.push_back(engine_request(made->sampled, made->made_of.motion));
          jobs.push_back({requests.back(), made->echo, made->statistics});
        }
      } catch (const RequestError&) {
        continue;  // reported when the ping is rendered
      }
    }
    try {
      engine.images(jobs);
    } catch (const RequestError&) {
      for (const int head : heads) {
        begun.erase(head);
      }
    }
  }
};

SonarRenderer::SonarRenderer(const World& world, const RendererOptions& options)
    : impl_(std::make_unique<Impl>(world, options)) {}
SonarRenderer::~SonarRenderer() = default;

EngineKind SonarRenderer::engine() const {
  return impl_->engine.kind();
}

const std::string& SonarRenderer::engine_description() const {
  return impl_->engine.description();
}

void SonarRenderer::use_engine(EngineKind engine) {
  impl_->engine.use(engine);
  ++impl_->world_revision;  // images of the other engine are no longer valid
}

bool SonarRenderer::set_body_pose(const std::string& body_name, const Pose& T_world_body) {
  const Pose pose = checked(T_world_body);
  const auto known = impl_->body_number.find(body_name);
  if (known == impl_->body_number.end()) {
    return false;
  }
  impl_->set_body_pose(known->second, pose);
  return true;
}

void SonarRenderer::begin_pings(std::span<const HeadRequest> pings) {
  impl_->begin(pings);
}

const EchoImage& SonarRenderer::render_echo(const PingRequest& request, int head) {
  check(request.settings);
  impl_->statistics = {};
  const SonarMotion motion = impl_->motion_of(request);
  impl_->is_begun(head, request, motion);  // drops an advance result for another ping
  CachedEcho& cached = impl_->cached_echoes[head];
  if (impl_->skip.on(SkipRule::unchanged_scene) && cached.fits(request, motion, impl_->world_revision)) {
    impl_->statistics.skipped.add(SkipRule::unchanged_scene);
    impl_->statistics.sees_surface = cached.sees_surface;
    return cached.image;
  }
  cached.world_revision = 0;  // until the image is complete
  if (request.settings.directions.any()) {
    cached.image = {};
    impl_->render_directions(request, head, motion.T_world_sonar, cached.directions);
  } else {
    cached.directions = {};
    impl_->render_echo(request, head, motion, cached.image);
  }
  cached.sees_surface = impl_->statistics.sees_surface;
  cached.keep_inputs(request, motion, impl_->world_revision);
  return cached.image;
}

const DirectionEchoes& SonarRenderer::render_directions(const PingRequest& request, int head) {
  render_echo(request, head);
  return impl_->cached_echoes[head].directions;
}

PingSamples SonarRenderer::render_ping(const PingRequest& request, int head) {
  const EchoImage& echo = render_echo(request, head);
  if (request.settings.directions.any()) {
    PingSamples samples;
    samples.directions = impl_->cached_echoes[head].directions;
    return samples;
  }
  Stopwatch watch;
  PingSamples samples = impl_->receiver.receive(echo, request, head, impl_->workers);
  impl_->statistics.seconds.receiver = watch.lap();
  impl_->statistics.skipped += impl_->receiver.skipped();
  impl_->statistics.echo_over_floor = impl_->receiver.echo_over_floor();
  return samples;
}

void SonarRenderer::forget(int head) {
  impl_->cached_echoes.erase(head);
  impl_->receiver.forget(head);
}

bool SonarRenderer::pass_ping(const PingRequest& request, int head) {
  check(request.settings);
  impl_->statistics = {};
  return impl_->receiver.pass(request, head, impl_->workers);
}

const PingStatistics& SonarRenderer::last_statistics() const {
  return impl_->statistics;
}

}  // namespace sonard::render
