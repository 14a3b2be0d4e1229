// SPDX-License-Identifier: Apache-2.0
#include "renderer/pipeline/self_test.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "renderer/pipeline/image_difference.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"

namespace sonard::render {

namespace {

constexpr double wall_m = 10.0;
constexpr double worst_error = 0.05;

World make_wall() {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->positions = {{0, -60, -60}, {0, 60, -60}, {0, 60, 60}, {0, -60, 60}};
  mesh->indices = {0, 2, 1, 0, 3, 2};
  BodyPart part;
  part.mesh = mesh;
  part.material.lambert_mu = 1.0;
  Body wall{"wall", {}, {part}};
  wall.T_world_body.position_m.x = wall_m;
  World world;
  world.bodies.push_back(wall);
  return world;
}

/// Integral of cos^4 from 0 to u.
double cos4_integral(double u) {
  return 3 * u / 8 + std::sin(2 * u) / 4 + std::sin(4 * u) / 32;
}

/// Adds the echo of one azimuth to the lines of its beam (docs/physics.md 3.2, T2). At this azimuth a
/// perpendicular wall is at range wall / (cos psi cos theta), so each range bounds an elevation. Lines nearer
/// or farther than the wall within `elevation_limit` stay 0.
void add_wall_echo(double psi, double width_rad, double elevation_limit, const RangeBins& range,
                   std::vector<double>& lines) {
  const double c = std::cos(psi);
  const double scale = 2 * c * c * c / (wall_m * wall_m) * width_rad;
  const double nearest_m = wall_m / c, farthest_m = nearest_m / std::cos(elevation_limit);
  double below = 0;
  for (int k = static_cast<int>(nearest_m / range.step_m); k < range.count; ++k) {
    const double to_m = (k + 1) * range.step_m;
    const double within =
        cos4_integral(to_m < farthest_m ? std::acos(std::min(1.0, nearest_m / to_m)) : elevation_limit);
    lines[static_cast<std::size_t>(k)] += scale * (within - below);
    if (to_m >= farthest_m) {
      return;
    }
    below = within;
  }
}

/// Integrates over the width of each beam by the midpoint rule.
EchoImage closed_form(const SonarSettings& settings) {
  constexpr int steps = 400;
  EchoImage image{settings.aperture.beam_count(), settings.range.count, {}};
  for (int beam = 0; beam < image.beams; ++beam) {
    const double psi_from = settings.aperture.beam_edges_rad[static_cast<std::size_t>(beam) + 1];
    const double psi_to = settings.aperture.beam_edges_rad[static_cast<std::size_t>(beam)];
    const double step = (psi_to - psi_from) / steps;
    std::vector<double> lines(static_cast<std::size_t>(image.bins));
    for (int i = 0; i < steps; ++i) {
      add_wall_echo(psi_from + (i + 0.5) * step, step, settings.aperture.elevation_limit_rad(),
                    settings.range, lines);
    }
    image.intensity.insert(image.intensity.end(), lines.begin(), lines.end());
  }
  return image;
}

SonarSettings wall_settings(int beams, int lines) {
  SonarSettings settings;
  settings.aperture.beam_edges_rad = equal_sine_edges(beams, 1.0471975511965976);
  settings.range = {lines, 0.02, 0, false};
  settings.physical.absorption_db_per_m = 0.0;
  return settings;
}

}  // namespace

SelfTestResult run_self_test(RendererOptions options) {
  options.gpu.lose_context_at_image = 0;
  SonarRenderer renderer(make_wall(), options);
  PingRequest request;
  request.settings = wall_settings(16, 1200);
  const EchoImage truth = closed_form(request.settings);
  SelfTestResult result;
  // Fixed grids use other code than presets, and on the GPU other shaders.
  for (const Sampling& sampling : {Sampling{}, Sampling::of_grid(3, 64, 256)}) {
    request.settings.sampling = sampling;
    const double error = bin_rms(renderer.render_echo(request), truth);
    if (!(error < worst_error)) {
      throw RendererError(fmt::format(
          "self-test failed: the echo of a wall, with {}, differs by {:.1f} % RMS from its closed form on {}",
          sampling.preset == Sampling::Preset::grid ? "a fixed grid" : "the default preset", error * 100,
          renderer.engine_description()));
    }
    result.error = std::max(result.error, error);
    if (options.engine == EngineKind::gpu && renderer.last_statistics().gpu.passes == 0) {
      throw RendererError("self-test failed: the GPU did not render the image: " +
                          renderer.engine_description());
    }
  }
  result.engine = renderer.engine_description();
  return result;
}

EngineTrial time_engines(const RendererOptions& options) {
  SonarRenderer renderer(make_wall(), options);
  HeadRequest ping;
  ping.request.settings = wall_settings(256, 1000);
  return choose_engine_at_start(renderer, std::vector{ping}, options.gpu);
}

}  // namespace sonard::render
