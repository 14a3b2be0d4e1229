// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/points.hpp"

#include <fmt/format.h>
#include <cmath>

namespace sonard::bench {

namespace {

constexpr double wide_fan_rad = 1.0;  // in wider fans, one planar view would waste samples at its sides

/// Views of equal angle have columns of equal tangent, so C columns per beam is a mean.
render::Sampling grid(const render::Aperture& aperture, int columns_per_beam, int rows) {
  render::Sampling sampling;
  sampling.preset = render::Sampling::Preset::grid;
  const double width_rad = aperture.beam_edges_rad.front() - aperture.beam_edges_rad.back();
  sampling.views = width_rad > wide_fan_rad ? 3 : 1;
  sampling.columns_per_view = static_cast<int>(
      std::ceil(static_cast<double>(columns_per_beam) * aperture.beam_count() / sampling.views));
  sampling.rows = rows;
  return sampling;
}

Point preset_point(const std::string& name, render::Sampling::Preset preset) {
  return {name, [=](render::SonarSettings& settings) {
            settings.sampling = {};
            settings.sampling.preset = preset;
          }};
}

}  // namespace

std::vector<Point> preset_points() {
  return {preset_point("fast", render::Sampling::Preset::fast), default_point(),
          preset_point("reference", render::Sampling::Preset::reference)};
}

Point default_point() {
  return preset_point("default", render::Sampling::Preset::normal);
}

Point grid_point(int columns_per_beam, int rows) {
  return {fmt::format("grid_{}x{}", columns_per_beam, rows), [=](render::SonarSettings& settings) {
            settings.sampling = grid(settings.aperture, columns_per_beam, rows);
          }};
}

Point point_binning(int columns_per_beam, int rows) {
  return {fmt::format("point_{}x{}", columns_per_beam, rows), [=](render::SonarSettings& settings) {
            settings.sampling = grid(settings.aperture, columns_per_beam, rows);
            settings.sampling.footprint = false;
          }};
}

Point paper_point() {
  const auto apply = [](render::SonarSettings& settings) {
    settings.model = render::Model::paper;
    settings.paper.footprint = false;
    settings.paper.elevation_mask = false;
    settings.paper.legacy_bin_index = true;
    settings.paper.legacy_columns = true;
    settings.sampling.preset = render::Sampling::Preset::grid;
    settings.sampling.views = 1;
    settings.sampling.columns_per_view = 4 * settings.aperture.beam_count();
    settings.sampling.rows = 512;
  };
  return {"paper", apply, false};
}

}  // namespace sonard::bench
