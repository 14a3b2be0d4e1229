// SPDX-License-Identifier: Apache-2.0
#include "tests/gl/scenes_of_the_paper/scene_echo.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "protocol/micron/units.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "tests/pictures/gallery/scenes.hpp"

namespace sonard::test {
namespace {

/// Keeps the first of every `every` elements.
template <class Element>
void thin_out(std::vector<Element>& elements, std::size_t every) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < elements.size(); i += every) {
    elements[kept++] = elements[i];
  }
  elements.resize(kept);
}

pictures::View view_without_effects(const std::string& name, std::size_t every_line) {
  for (const pictures::GalleryScene& scene : pictures::gallery_scenes()) {
    if (scene.name == name) {
      pictures::View view = pictures::view_of(scene);
      pictures::take_effects_off(view);
      thin_out(view.scan, every_line);
      view.settings.sampling.preset = render::Sampling::Preset::fast;
      return view;
    }
  }
  throw std::invalid_argument(name + ": no such scene");
}

}  // namespace

SceneEcho::SceneEcho(const std::string& name, const render::RendererOptions& options, std::size_t every_line)
    : view_(view_without_effects(name, every_line)),
      lines_(view_.settings.range.count),
      step_m_(view_.settings.range.step_m) {
  render::SonarRenderer renderer(view_.world, options);
  const auto add = [&](const render::Pose& T_world_sonar) {
    const render::EchoImage& image = renderer.render_echo({T_world_sonar, view_.settings, 0, 0});
    beams_ += image.beams;
    intensity_.insert(intensity_.end(), image.intensity.begin(), image.intensity.end());
  };
  if (view_.scan.empty()) {
    add(view_.T_world_sonar);
  }
  for (const pictures::ScanLine& line : view_.scan) {
    add(line.T_world_sonar);
  }
}

double SceneEcho::azimuth_rad(int beam) const {
  const auto b = static_cast<std::size_t>(beam);
  if (!view_.scan.empty()) {
    return -micron::bearing_rad(view_.scan[b].bearing);
  }
  const std::vector<double>& edges = view_.settings.aperture.beam_edges_rad;
  return 0.5 * (edges[b] + edges[b + 1]);
}

int SceneEcho::beam_at(double azimuth_rad) const {
  const auto distance = [&](int beam) {
    return std::abs(std::remainder(this->azimuth_rad(beam) - azimuth_rad, 2 * std::numbers::pi));
  };
  int nearest = 0;
  for (int beam = 1; beam < beams_; ++beam) {
    nearest = distance(beam) < distance(nearest) ? beam : nearest;
  }
  return nearest;
}

double SceneEcho::at(int beam, int line) const {
  return static_cast<double>(intensity_.at(static_cast<std::size_t>(beam) * static_cast<std::size_t>(lines_) +
                                           static_cast<std::size_t>(line)));
}

int SceneEcho::line_at(double range_m) const {
  return std::clamp(static_cast<int>(std::ceil(range_m / step_m_)), 0, lines_);
}

double SceneEcho::energy(int beam, double from_m, double to_m) const {
  double sum = 0;
  for (int line = line_at(from_m); line < line_at(to_m); ++line) {
    sum += at(beam, line);
  }
  return sum;
}

double SceneEcho::first_range_m(int beam, double from_m, double threshold) const {
  for (int line = line_at(from_m); line < lines_; ++line) {
    if (at(beam, line) > threshold) {
      return (line + 0.5) * step_m_;
    }
  }
  return std::numeric_limits<double>::infinity();
}

double SceneEcho::strongest_range_m(int beam, double from_m, double to_m) const {
  int strongest = line_at(from_m);
  for (int line = strongest; line < line_at(to_m); ++line) {
    strongest = at(beam, line) > at(beam, strongest) ? line : strongest;
  }
  return (strongest + 0.5) * step_m_;
}

double SceneEcho::strongest(int beam, double from_m, double to_m) const {
  double most = 0;
  for (int line = line_at(from_m); line < line_at(to_m); ++line) {
    most = std::max(most, at(beam, line));
  }
  return most;
}

double SceneEcho::median(int beam, double from_m, double to_m) const {
  std::vector<double> values;
  for (int line = line_at(from_m); line < line_at(to_m); ++line) {
    values.push_back(at(beam, line));
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace sonard::test
