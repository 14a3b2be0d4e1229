// SPDX-License-Identifier: Apache-2.0
#include "tests/pictures/draw_view.hpp"

#include <cstdint>
#include <utility>
#include <vector>

#include "renderer/picture/fan_image.hpp"
#include "renderer/picture/sweep_image.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"

namespace sonard::pictures {
namespace {

picture::FanShape shape_of(const View& view) {
  const render::SonarSettings& settings = view.settings;
  const std::vector<double>& edges = settings.aperture.beam_edges_rad;
  picture::FanShape shape;
  for (std::size_t b = 0; b + 1 < edges.size(); ++b) {
    shape.bearings_rad.push_back(-0.5 * (edges[b] + edges[b + 1]));  // positive to starboard
  }
  shape.lines = settings.range.output_count();
  shape.line_step_m = view.display_scale * settings.range.step_m * (1 << settings.range.compression_log2);
  return shape;
}

cv::Mat draw_fan(render::SonarRenderer& renderer, const View& view, const picture::FanStyle& style,
                 const std::string& caption) {
  render::PingSamples samples =
      renderer.render_ping({view.T_world_sonar, view.settings, 0, 1, view.T_world_sonar_at_end});
  const cv::Mat polar(samples.bins, samples.beams, CV_8UC1, samples.u8.data());
  return picture::FanImage(shape_of(view), style).draw(polar, caption);
}

cv::Mat draw_sweep(render::SonarRenderer& renderer, const View& view, const picture::FanStyle& style,
                   const std::string& caption) {
  picture::SweepShape shape;
  shape.step = view.scan_step;
  shape.bins = view.settings.range.output_count();
  shape.bin_m = view.settings.range.step_m * (1 << view.settings.range.compression_log2);
  std::vector<picture::SweepLine> lines;
  std::uint64_t ping_number = 0;
  for (const ScanLine& line : view.scan) {
    render::PingSamples samples = renderer.render_ping({line.T_world_sonar, view.settings, ping_number++, 1});
    lines.push_back({line.bearing, std::move(samples.u8)});
  }
  return picture::SweepImage(shape, style).draw(lines, caption);
}

}  // namespace

cv::Mat draw_view(const View& view, render::EngineKind engine, int radius_px, const std::string& caption) {
  render::RendererOptions options;
  options.engine = engine;
  options.ray_curvature_per_m = view.ray_curvature_per_m;
  render::SonarRenderer renderer(view.world, options);
  const picture::FanStyle style{radius_px, true};
  return view.scan.empty() ? draw_fan(renderer, view, style, caption)
                           : draw_sweep(renderer, view, style, caption);
}

}  // namespace sonard::pictures
