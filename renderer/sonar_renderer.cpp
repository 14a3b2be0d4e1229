#include "renderer/sonar_renderer.hpp"

#include <chrono>
#include <cmath>
#include <optional>

#include "renderer/acoustics/receiver.hpp"
#include "renderer/binning/echo_binner.hpp"
#include "renderer/visibility/sample_grid.hpp"
#include "renderer/visibility/sampler_choice.hpp"
#include "renderer/visibility/slices/slice_sampler.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

namespace {

constexpr int most_native_lines = 65535;  // a Gemini's line count is 16 bits wide
constexpr int most_beams = 4096;
constexpr double shortest_line_m = 1e-6;
constexpr double longest_range_m = 1e5;
// Surfaces a little beyond the last line are still sampled, so that footprints which cross it are complete.
constexpr double range_margin = 1.05;

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

SurfaceModel surface_model(const SonarSettings& settings) {
  SurfaceModel surface;
  surface.model = settings.model;
  if (settings.model == Model::paper) {
    surface.sigmoid_slope = settings.paper.sigmoid_slope;
    surface.sigmoid_centre = settings.paper.sigmoid_centre;
    surface.attenuation_per_m = settings.paper.attenuation_per_m;
    surface.two_sided = settings.paper.two_sided;
  }
  return surface;
}

BinningOptions binning_options(const SonarSettings& settings) {
  BinningOptions options;
  options.footprint = settings.sampling.footprint;
  if (settings.model == Model::paper) {
    options.mean = true;
    options.footprint = options.footprint && settings.paper.footprint;
    options.legacy_bin_index = settings.paper.legacy_bin_index && !options.footprint;
  }
  return options;
}

/// Spherical spreading and absorption, two ways, of every native line (docs/physics.md 2.1, equation 1).
void apply_propagation(const SonarSettings& settings, EchoImage& image) {
  std::vector<float> loss(static_cast<std::size_t>(image.lines));
  for (std::size_t k = 0; k < loss.size(); ++k) {
    const double range_m = (static_cast<double>(k) + 0.5) * settings.range.step_m;
    loss[k] = static_cast<float>(std::pow(10.0, -settings.physical.absorption_db_per_m * range_m / 5) /
                                 (range_m * range_m));
  }
  for (std::size_t beam = 0; beam < static_cast<std::size_t>(image.beams); ++beam) {
    float* line = &image.intensity[beam * loss.size()];
    for (std::size_t k = 0; k < loss.size(); ++k) {
      line[k] *= loss[k];
    }
  }
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

}  // namespace

namespace {

/// What the paper's variants ask for that only a grid of pixels has.
bool needs_grid(const SonarSettings& settings) {
  const PaperModel& paper = settings.paper;
  return settings.sampling.preset == Sampling::Preset::grid || !settings.sampling.footprint ||
         (settings.model == Model::paper &&
          (!paper.footprint || paper.legacy_bin_index || paper.legacy_columns || !paper.elevation_mask));
}

SliceAccuracy slice_accuracy(const SonarSettings& settings) {
  // The paper's sigmoid makes more of small changes of incidence.
  const int slices = settings.model == Model::paper ? 2 : 1;
  switch (settings.sampling.preset) {
    case Sampling::Preset::fast:
      return {slices, 4, 2.5e-2F, 0.1F, 0.05F};
    case Sampling::Preset::reference:
      return {8, 16, 1e-6F, 0.005F, 0.001F};
    default:
      return {slices, 64, 1e-3F, 0.04F, 0.01F};
  }
}

}  // namespace

struct SonarRenderer::Impl {
  WorkerPool workers;  // outlives the sampler, which uses it
  ChosenSampler chosen;
  std::unique_ptr<SliceSampler> slices;  // of the backend `ray`
  Receiver receiver;
  PingStatistics statistics;

  Impl(const World& world, const RendererOptions& options)
      : workers(options.threads), chosen(choose_sampler(world, options.backend, workers)) {
    if (chosen.backend == Backend::ray) {
      slices = std::make_unique<SliceSampler>(world, workers);
    }
  }

  /// Finds what is visible and bins it; fills the statistics of both.
  BinningResult look(const PingRequest& request, const Pose& T_world_sonar) {
    const SonarSettings& settings = request.settings;
    const double max_range_m = settings.range.max_range_m() * range_margin;
    const SurfaceModel surface = surface_model(settings);
    BinningResult bins;
    Stopwatch watch;
    if (slices && !needs_grid(settings)) {
      const auto cells = slices->sample(T_world_sonar, settings.aperture, settings.range.step_m, max_range_m,
                                        surface, slice_accuracy(settings));
      statistics.visibility_s = watch.lap();
      bins = bin_echoes(cells, settings.aperture, settings.range, binning_options(settings), workers);
    } else {
      const SampleGrid& samples = grid_for(settings);
      const auto views = chosen.sampler->sample(T_world_sonar, samples, surface, max_range_m);
      statistics.visibility_s = watch.lap();
      bins = bin_echoes(samples, views, settings.range, binning_options(settings), workers);
    }
    statistics.binning_s = watch.lap();
    statistics.samples = bins.samples;
    statistics.invalid_samples = bins.invalid_samples;
    return bins;
  }

  /// Grids cost more to make than a ping: the last one is kept for as long as the same aperture is asked for.
  const SampleGrid& grid_for(const SonarSettings& settings) {
    const GridOptions options = grid_options(settings);
    if (!grid_key || !same_grid(*grid_key, settings) || made_with != options) {
      grid_key.reset();
      grid = make_sample_grid(settings.aperture, settings.sampling, options);
      grid_key = settings;
      made_with = options;
    }
    return grid;
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
  if (impl_->slices) {
    impl_->slices->set_body_pose(body_name, pose);
  }
  return impl_->chosen.sampler->set_body_pose(body_name, pose);
}

EchoImage SonarRenderer::render_echo(const PingRequest& request) {
  const SonarSettings& settings = request.settings;
  check(settings);
  const Pose T_world_sonar = checked(request.T_world_sonar);
  EchoImage image{settings.aperture.beam_count(), settings.range.count, {}};
  impl_->statistics = {};
  if (!settings.transmit) {
    image.intensity.resize(static_cast<std::size_t>(image.beams) * static_cast<std::size_t>(image.lines));
    return image;
  }
  image.intensity = impl_->look(request, T_world_sonar).echo;
  Stopwatch watch;
  if (settings.model == Model::physical) {
    apply_propagation(settings, image);
  }
  impl_->statistics.binning_s += watch.lap();
  return image;
}

PingSamples SonarRenderer::render_ping(const PingRequest& request, int stream) {
  const EchoImage echo = render_echo(request);
  Stopwatch watch;
  PingSamples samples = impl_->receiver.receive(echo, request, stream, impl_->workers);
  impl_->statistics.receiver_s = watch.lap();
  return samples;
}

const PingStatistics& SonarRenderer::last_statistics() const {
  return impl_->statistics;
}

}  // namespace sonard::render
