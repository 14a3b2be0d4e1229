// SPDX-License-Identifier: Apache-2.0
// How fast the error falls with the number of rows, against closed forms. The grids are fixed, because an
// error preset chooses its own samples. Limits of the finest errors are 1.1 times a measured error.
#include <cmath>
#include <vector>

#include "tests/bench/image_error.hpp"
#include "tests/bench/plane_quadrature.hpp"
#include "tests/scenes/scenes.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::test {
namespace {

constexpr int columns_per_beam = 16;  // enough that only rows limit

/// Two beams of half a degree from `psi` on, to starboard.
Scene narrowed(Scene scene, double psi) {
  scene.settings.aperture.beam_edges_rad = {psi, psi - 0.008, psi - 0.016};
  return scene;
}

render::EchoImage truth_of(const Scene& scene) {
  const auto& edges = scene.settings.aperture.beam_edges_rad;
  const render::RangeBins& range = scene.settings.range;
  render::EchoImage image{scene.settings.aperture.beam_count(), range.count, {}};
  for (std::size_t b = 0; b + 1 < edges.size(); ++b) {
    for (int k = 0; k < range.count; ++k) {
      const double from_m = std::max(1e-9, k * range.step_m);
      image.intensity.push_back(
          static_cast<float>(scene_lambert_mu * bench::plane_beam_echo(*scene.plane, edges[b + 1], edges[b],
                                                                       from_m, (k + 1) * range.step_m)));
    }
  }
  return image;
}

class Convergence : public EngineTest {
 protected:
  /// Pooled error of a scene at several bearings, for each number of rows.
  static std::vector<double> errors(const Scene& scene, const std::vector<double>& bearings,
                                    const std::vector<int>& rows) {
    render::SonarRenderer renderer(scene.world, options());
    std::vector<double> squares(rows.size(), 0);
    double bins = 0;
    for (const double bearing : bearings) {
      const Scene part = narrowed(scene, bearing);
      const render::EchoImage truth = truth_of(part);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        render::PingRequest request = part.request();
        request.settings.sampling.preset = render::Sampling::Preset::grid;
        request.settings.sampling.views = 1;
        request.settings.sampling.columns_per_view = 2 * columns_per_beam;
        request.settings.sampling.rows = rows[i];
        const auto error = bench::compare_images(renderer.render_echo(request), truth);
        EXPECT_TRUE(error.has_value());
        squares[i] += error->bin_rms * error->bin_rms * static_cast<double>(error->bins);
        bins += i == 0 ? static_cast<double>(error->bins) : 0;
      }
    }
    std::vector<double> result;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      result.push_back(std::sqrt(squares[i] / bins));
      std::printf("%d rows: %.3e\n", rows[i], result.back());
    }
    return result;
  }

  /// p of error ~ rows^-p, by least squares.
  static double order(const std::vector<int>& rows, const std::vector<double>& errors) {
    double x0 = 0, y0 = 0, xx = 0, xy = 0;
    const auto count = static_cast<double>(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      x0 += std::log(rows[i]) / count;
      y0 += std::log(errors[i]) / count;
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      xx += (std::log(rows[i]) - x0) * (std::log(rows[i]) - x0);
      xy += (std::log(rows[i]) - x0) * (std::log(errors[i]) - y0);
    }
    std::printf("order %.2f\n", -xy / xx);
    return -xy / xx;
  }
};

INSTANTIATE_TEST_SUITE_P(Engines, Convergence, all_engines(), engine_name);

// On a wall at 10 m, one of 64 rows is 9 mm deep at the edge of the fan: about a bin. More rows are less
// deep. The wall's nearest point lies where two bins meet, so the last digit of a range affects the order:
// 1.60 to 2.15 were measured.
TEST_P(Convergence, T2Wall) {
  const std::vector<int> rows{64, 96, 128};
  const std::vector<double> found = errors(make_scene("b1_wall"), {0.35, 0.7, 1.047}, rows);
  EXPECT_GE(order(rows, found), 1.5);
  EXPECT_LT(found.back(), 1.1 * 4.6e-4);
}

TEST_P(Convergence, T1TiltedSonarOverABed) {
  const std::vector<int> rows{512, 724, 1024};
  const std::vector<double> found = errors(make_scene("plane"), {0.02, 0.5}, rows);
  EXPECT_GE(order(rows, found), 1.7);
  EXPECT_LT(found.back(), 1.1 * 1.6e-4);
}

TEST_P(Convergence, T3SeabedWithRowsBelowABin) {
  const std::vector<int> rows{1024, 1448, 2048};
  const std::vector<double> found = errors(make_scene("b2_seabed_5m"), {0.3}, rows);
  EXPECT_GE(order(rows, found), 1.7);
  EXPECT_LT(found.back(), 1.1 * 3.0e-4);
}

// If a row spreads over many bins, the footprint still converges, at least with first order.
TEST_P(Convergence, T3SeabedWithRowsAboveABin) {
  const std::vector<int> rows{64, 128, 256, 512};
  const std::vector<double> found = errors(make_scene("b2_seabed_5m"), {0.3}, rows);
  EXPECT_GE(order(rows, found), 0.9);
  EXPECT_LT(found.back(), 1.1 * 3.7e-3);
}

}  // namespace
}  // namespace sonard::test
