// SPDX-License-Identifier: Apache-2.0
// Worlds and sums for tests of multipath. Each test computes its truth from docs/physics.md 2.11.
#pragma once

#include <cmath>
#include <vector>

#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::test {

/// A Gemini-like fan of `beams` equal angles over 120 degrees; no absorption, no pattern.
inline render::PingRequest fan_request(int beams, double height_deg, double range_m, double step_m) {
  render::PingRequest request;
  request.settings.aperture.beam_edges_rad = render::equal_angle_edges(beams, 120 * degree);
  request.settings.aperture.vertical_beamwidth_rad = height_deg * degree;
  request.settings.range = {static_cast<int>(std::lround(range_m / step_m)), step_m, 0, false};
  request.settings.physical.absorption_db_per_m = 0;
  request.settings.physical.backscatter = render::PhysicalModel::Backscatter::lambert;
  request.settings.physical.multipath.water_surface_rms_height_m = 0;
  return request;
}

/// Each test runs with both presets on both engines, because the cells of ghosts depend on the preset.
struct PathCase {
  render::EngineKind engine;
  render::Sampling::Preset preset;
};

class PathTest : public ::testing::TestWithParam<PathCase> {
 protected:
  void SetUp() override {
    if (GetParam().engine == render::EngineKind::gpu) {
      require_gl();
    }
  }
  static render::RendererOptions options(unsigned threads = 0) { return {GetParam().engine, threads}; }
  static render::PingRequest fan_request(int beams, double height_deg, double range_m, double step_m) {
    render::PingRequest request = test::fan_request(beams, height_deg, range_m, step_m);
    request.settings.sampling.preset = GetParam().preset;
    return request;
  }
};

inline auto path_cases() {
  using render::EngineKind, render::Sampling;
  return ::testing::Values(
      PathCase{EngineKind::gpu, Sampling::Preset::fast}, PathCase{EngineKind::gpu, Sampling::Preset::normal},
      PathCase{EngineKind::cpu, Sampling::Preset::fast}, PathCase{EngineKind::cpu, Sampling::Preset::normal});
}

inline std::string path_case_name(const ::testing::TestParamInfo<PathCase>& info) {
  return std::string(render::name_of(info.param.engine)) +
         (info.param.preset == render::Sampling::Preset::fast ? "_fast" : "_default");
}

inline render::Body smooth_body(const std::string& name, render::TriangleMesh mesh, double reflection = 1.0,
                                double rms_height_m = 0.0, double lambert_mu = 0.0) {
  render::Body body = make_body(name, std::move(mesh), lambert_mu);
  body.parts[0].material.pressure_reflection = reflection;
  body.parts[0].material.rms_height_m = rms_height_m;
  return body;
}

/// Scatters only: no facets, no mirror.
inline render::Body rough_body(const std::string& name, render::TriangleMesh mesh, double lambert_mu = 0.1) {
  return smooth_body(name, std::move(mesh), 0.0, 0.0, lambert_mu);
}

/// Sum over bins of lines that touch [from_m, to_m] in the beams whose middle is within (from_deg, to_deg).
inline double energy(const render::EchoImage& image, const render::SonarSettings& settings, double from_m,
                     double to_m, double from_deg = -60, double to_deg = 60) {
  const auto& edges = settings.aperture.beam_edges_rad;
  double sum = 0.0;
  for (int beam = 0; beam < image.beams; ++beam) {
    const auto b = static_cast<std::size_t>(beam);
    const double middle_deg = 0.5 * (edges[b] + edges[b + 1]) / degree;
    if (middle_deg < from_deg || middle_deg > to_deg) {
      continue;
    }
    for (int line = 0; line < image.bins; ++line) {
      if ((line + 1) * settings.range.step_m > from_m && line * settings.range.step_m <= to_m) {
        sum += static_cast<double>(image.at(beam, line));
      }
    }
  }
  return sum;
}

/// The line with the largest energy() over the same beams; -1 if there is no echo.
inline int strongest_line(const render::EchoImage& image, const render::SonarSettings& settings,
                          double from_m, double to_m, double from_deg = -60, double to_deg = 60) {
  int strongest = -1;
  double most = 0.0;
  const double step_m = settings.range.step_m;
  for (int line = static_cast<int>(from_m / step_m); line <= static_cast<int>(to_m / step_m); ++line) {
    const double middle_m = (line + 0.5) * step_m;
    const double sum = energy(image, settings, middle_m, middle_m, from_deg, to_deg);
    if (sum > most) {
      most = sum;
      strongest = line;
    }
  }
  return strongest;
}

inline double decibels(double ratio) {
  return 10 * std::log10(ratio);
}

}  // namespace sonard::test
