// SPDX-License-Identifier: Apache-2.0
// Echo energy against closed forms (docs/physics.md 3.2) in the range bins of the demo, and on fixed grids.
// accuracy_test does not test these for `gpu`.
#include <cmath>

#include "tests/support/closed_forms.hpp"
#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using test::EngineTest;
using test::make_body;
using test::make_quad;
using test::make_world;
using test::PlaneTruth;

constexpr double error_bound = 0.02;

/// 256 beams over 120 x 20 degrees, range bins of 8.29 mm, no absorption.
PingRequest gemini_request(int lines) {
  PingRequest request;
  request.settings.aperture.beam_edges_rad = equal_sine_edges(256, 60 * degree);
  request.settings.range = {lines, 1500.0 / 180844, 0, false};
  request.settings.physical.absorption_db_per_m = 0;
  return request;
}

struct Comparison {
  double worst_rms = 0;    // of the worst beam
  double worst_total = 0;  // relative error of a beam's total echo
  int holes = 0;           // empty although above -60 dB of the beam's maximum
};

Comparison compare(const EchoImage& image, const PingRequest& request, const PlaneTruth& truth) {
  Comparison result;
  const auto& edges = request.settings.aperture.beam_edges_rad;
  for (const int beam : {0, 1, 7, 31, 64, 85, 86, 127, 128, 170, 171, 200, 254, 255}) {
    const auto b = static_cast<std::size_t>(beam);
    std::vector<double> expected, measured;
    double expected_sum = 0, measured_sum = 0;
    for (int k = 0; k < image.bins; ++k) {
      const double from = std::max(1e-6, k * request.settings.range.step_m);
      expected.push_back(
          truth.beam(edges[b + 1], edges[b], from, (k + 1) * request.settings.range.step_m, 800));
      measured.push_back(static_cast<double>(image.at(beam, k)));
      expected_sum += expected.back();
      measured_sum += measured.back();
    }
    const double strongest = *std::max_element(expected.begin(), expected.end());
    for (std::size_t k = 0; k < expected.size(); ++k) {
      result.holes += expected[k] > 1e-6 * strongest && measured[k] == 0 ? 1 : 0;
    }
    result.worst_rms = std::max(result.worst_rms, test::rms_error(expected, measured, 1e-2));
    result.worst_total = std::max(result.worst_total, std::abs(measured_sum / expected_sum - 1));
  }
  return result;
}

void expect_truth(const Comparison& comparison) {
  std::printf("worst beam: RMS %.4f, total %.5f, holes %d\n", comparison.worst_rms, comparison.worst_total,
              comparison.holes);
  EXPECT_LT(comparison.worst_rms, error_bound);
  EXPECT_LT(comparison.worst_total, 0.005);
  EXPECT_EQ(comparison.holes, 0);
}

class ClosedForm : public EngineTest {};

INSTANTIATE_TEST_SUITE_P(Engines, ClosedForm, test::all_engines(), test::engine_name);

TEST_P(ClosedForm, T1ObliqueSlope) {
  // A plane through (9, 0, 0) whose normal points away, to port and up.
  const glm::dvec3 n = glm::normalize(glm::dvec3(0.8, 0.35, -0.5));
  const glm::dvec3 a = glm::normalize(glm::cross(n, glm::dvec3(0, 0, 1)));
  const glm::dvec3 b = glm::cross(n, a);
  const glm::dvec3 corner = glm::dvec3(9, 0, 0) - 300.0 * a - 300.0 * b;
  SonarRenderer renderer(make_world({make_body("slope", make_quad(corner, 600.0 * a, 600.0 * b))}),
                         options());
  PingRequest request = gemini_request(4000);
  const double limit = request.settings.aperture.elevation_limit_rad();
  expect_truth(compare(renderer.render_echo(request), request, PlaneTruth{9 * n.x, n.x, n.y, n.z, limit}));
}

// Footprints near the limb reach beyond it, so silhouettes converge with first order. The total, 1.411161e-4
// by T4, is right on a coarse grid, the shape on a finer one.
TEST_P(ClosedForm, T4Sphere) {
  Body sphere = make_body("sphere", test::make_sphere(0.5F, 256));
  sphere.T_world_body.position_m = {8 * std::cos(20 * degree), 8 * std::sin(20 * degree), 0};
  SonarRenderer renderer(make_world({sphere}), options());
  PingRequest request = gemini_request(1100);
  const auto rms_and_total = [&] {
    const EchoImage image = renderer.render_echo(request);
    std::vector<double> expected, measured;
    double total = 0;
    for (int k = 0; k < image.bins; ++k) {
      const double step = request.settings.range.step_m;
      expected.push_back(test::sphere_echo(0.5, 8, k * step, (k + 1) * step));
      measured.push_back(0);
      for (int beam = 0; beam < image.beams; ++beam) {
        measured.back() += static_cast<double>(image.at(beam, k));
      }
      total += measured.back();
    }
    const double rms = test::rms_error(expected, measured, 1e-2);
    std::printf("sphere: RMS %.4f, total %.5f\n", rms, total / 1.411161e-4 - 1);
    return std::pair{rms, total};
  };
  request.settings.sampling = Sampling::of_grid(3, 256, 512);
  const auto [coarse_rms, coarse_total] = rms_and_total();
  EXPECT_NEAR(coarse_total / 1.411161e-4, 1, 0.005);
  request.settings.sampling = Sampling::of_grid(3, 1024, 2048);
  const auto [fine_rms, fine_total] = rms_and_total();
  EXPECT_NEAR(fine_total / 1.411161e-4, 1, 0.002);
  EXPECT_LT(fine_rms, 0.02);
  EXPECT_LT(fine_rms, 0.5 * coarse_rms);
}

// T6: beams left of the edge hold only the near wall, beams right of it only the far one, nothing in between.
TEST_P(ClosedForm, T6TwoHalfPlanes) {
  SonarRenderer renderer(make_world({make_body("near", make_quad({8, 0, -30}, {0, 60, 0}, {0, 0, 60})),
                                     make_body("far", make_quad({12, -90, -30}, {0, 180, 0}, {0, 0, 60}))}),
                         options());
  const PingRequest request = gemini_request(1700);
  const EchoImage image = renderer.render_echo(request);
  const auto first_line = [&](int beam) {
    int k = 0;
    while (k < image.bins && image.at(beam, k) == 0) {
      ++k;
    }
    return k;
  };
  const double step = request.settings.range.step_m;
  // The edge of the near wall is at psi = 0, between beams 127 and 128.
  EXPECT_NEAR(first_line(127), 8 / step, 1);
  EXPECT_NEAR(first_line(128), 12 / step, 1);
  for (int k = static_cast<int>(8.2 / step); k < static_cast<int>(11.9 / step); ++k) {
    EXPECT_EQ(image.at(127, k), 0) << k;
    EXPECT_EQ(image.at(128, k), 0) << k;
  }
}

// T7: thin wall 1.5 m high, 12 m away on a flat bed 5 m below: shadow on (13.0, 17.857) m.
TEST_P(ClosedForm, T7ShadowOfAWall) {
  SonarRenderer renderer(make_world({make_body("bed", make_quad({-200, -200, 0}, {400, 0, 0}, {0, 400, 0})),
                                     make_body("wall", make_quad({12, -60, 0}, {0, 120, 0}, {0, 0, 1.5}))}),
                         options());
  PingRequest request = gemini_request(900);
  request.settings.range.step_m = 0.025;
  request.settings.sampling =
      Sampling::of_grid(3, 256, 4096);  // a row then spans less than a line at the end of the shadow
  request.settings.aperture.vertical_beamwidth_rad = 60 * degree;
  request.T_world_sonar.position_m.z = 5;
  const EchoImage image = renderer.render_echo(request);
  const double step = request.settings.range.step_m;
  for (const int beam : {127, 128}) {
    const auto line = [&](double range_m) { return static_cast<int>(range_m / step); };
    for (int k = line(13.0) + 2; k < line(17.857) - 2; ++k) {
      ASSERT_EQ(image.at(beam, k), 0) << "beam " << beam << " line " << k;
    }
    EXPECT_GT(image.at(beam, line(13.0) - 2), 0);
    EXPECT_GT(image.at(beam, line(17.857) + 10), 0);
    // The wall and the bed in front of it share these ranges, so they are brighter than the bed alone.
    EXPECT_GT(image.at(beam, line(12.7)), 2 * image.at(beam, line(12.3)));
  }
}

}  // namespace
}  // namespace sonard::render
