// SPDX-License-Identifier: Apache-2.0
// Fixture for the stress list of tests/gl/stability/README.md: each test of an image runs on each way to
// render one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::test {

/// Lambert's mu of a passive, fully diffuse surface: the largest possible.
inline constexpr double full_mu = std::numbers::inv_pi;

enum class Way {
  gpu,         ///< engine `gpu` with a preset: slices in compute shaders
  cpu_slices,  ///< engine `cpu` as presets use it: exact in slices, refined if neighbours disagree
  cpu_grid,    ///< engine `cpu` on a fixed grid
};

inline std::string way_name(const ::testing::TestParamInfo<Way>& info) {
  switch (info.param) {
    case Way::gpu:
      return "gpu";
    case Way::cpu_slices:
      return "cpu_slices";
    case Way::cpu_grid:
      break;
  }
  return "cpu_grid";
}

class StabilityTest : public ::testing::TestWithParam<Way> {
 protected:
  void SetUp() override {
    if (GetParam() == Way::gpu) {
      require_gl();
    }
  }

  static render::RendererOptions options(unsigned threads = 0) {
    render::RendererOptions result;
    result.engine = GetParam() == Way::gpu ? render::EngineKind::gpu : render::EngineKind::cpu;
    result.threads = threads;
    return result;
  }

  /// The preset `default` for slices; a grid of this size for the others.
  static render::Sampling sampling(int columns_per_view = 128, int rows = 128) {
    return GetParam() == Way::cpu_slices ? render::Sampling{}
                                         : render::Sampling::of_grid(3, columns_per_view, rows);
  }

  /// Neither speckle nor noise nor absorption: 64 beams over 120 degrees, 16 m, 3 m up, 20 degrees down.
  static render::PingRequest quiet_request() {
    render::PingRequest request;
    render::SonarSettings& settings = request.settings;
    settings.aperture.beam_edges_rad = render::equal_sine_edges(64, 60 * degree);
    settings.range = {800, 0.02, 0, false};
    settings.sampling = sampling();
    settings.physical.absorption_db_per_m = 0;
    settings.physical.speckle.kind = render::SpeckleSettings::Kind::off;
    settings.physical.noise.on = false;
    settings.paper.speckle = render::PaperModel::Speckle::off;
    request.T_world_sonar.position_m.z = 3;
    request.T_world_sonar.orientation = glm::angleAxis(20 * degree, glm::dvec3(0, 1, 0));
    request.seed = 11;
    request.ping_number = 4;
    return request;
  }

  /// quiet_request() from the origin, straight ahead along x.
  static render::PingRequest level_request() {
    render::PingRequest request = quiet_request();
    request.T_world_sonar = {};
    return request;
  }
};

/// A bed, a ball and a crate on it, for quiet_request().
inline render::World small_harbour() {
  render::World world =
      make_world({make_body("bed", make_quad({-50, -50, 0}, {100, 0, 0}, {0, 100, 0}), 0.02),
                  make_body("ball", make_sphere(0.5F, 32), 0.1),
                  make_body("crate", make_quad({0, -0.4F, 0}, {0, 0.8F, 0}, {0, 0, 0.9F}), 0.05)});
  world.bodies[1].T_world_body.position_m = {8, 1, 0.5};
  world.bodies[2].T_world_body.position_m = {6, -2, 0};
  return world;
}

inline double sum(const render::EchoImage& image) {
  return std::accumulate(image.intensity.begin(), image.intensity.end(), 0.0);
}

inline double beam_sum(const render::EchoImage& image, int beam) {
  const auto begin = image.intensity.begin() + static_cast<std::ptrdiff_t>(beam) * image.bins;
  return std::accumulate(begin, begin + image.bins, 0.0);
}

inline float strongest(const render::EchoImage& image) {
  return *std::max_element(image.intensity.begin(), image.intensity.end());
}

inline bool is_sane(const render::EchoImage& image) {
  return std::all_of(image.intensity.begin(), image.intensity.end(),
                     [](float value) { return std::isfinite(value) && value >= 0; });
}

/// Share of the bins that differ by more than `tolerance` times the strongest of `a`.
inline double different_share(const render::EchoImage& a, const render::EchoImage& b, double tolerance) {
  EXPECT_EQ(a.intensity.size(), b.intensity.size());
  const double limit = tolerance * static_cast<double>(strongest(a));
  std::size_t different = 0;
  for (std::size_t i = 0; i < std::min(a.intensity.size(), b.intensity.size()); ++i) {
    const double difference =
        std::abs(static_cast<double>(a.intensity[i]) - static_cast<double>(b.intensity[i]));
    different += difference <= limit ? 0 : 1;  // NaN counts
  }
  return static_cast<double>(different) / static_cast<double>(a.intensity.size());
}

/// Silhouettes may move by less than a sample: this share of the bins may differ (docs/physics.md 4.3, S21).
inline constexpr double silhouette_share = 1e-3;

/// A strip of width `width_m` across the view 10 m ahead, its middle at azimuth or elevation `angle_rad`.
inline render::World strip(double width_m, double angle_rad, bool upright) {
  const auto w = static_cast<float>(width_m);
  render::Body body = make_body("strip",
                                upright ? make_quad({0, -w / 2, -5}, {0, w, 0}, {0, 0, 10})
                                        : make_quad({0, -5, -w / 2}, {0, 10, 0}, {0, 0, w}),
                                full_mu);
  const double aside = 10 * std::tan(angle_rad);
  body.T_world_body.position_m = upright ? glm::dvec3(10, aside, 0) : glm::dvec3(10, 0, aside);
  return make_world({body});
}

}  // namespace sonard::test

#define SONARD_STABILITY_SUITE(name)                                                                    \
  class name : public ::sonard::test::StabilityTest {};                                                 \
  INSTANTIATE_TEST_SUITE_P(Ways, name,                                                                  \
                           ::testing::Values(::sonard::test::Way::gpu, ::sonard::test::Way::cpu_slices, \
                                             ::sonard::test::Way::cpu_grid),                            \
                           ::sonard::test::way_name)
