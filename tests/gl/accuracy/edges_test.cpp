// SPDX-License-Identifier: Apache-2.0
// T6, T7 and T8: edges, shadows and corners.
#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/bench/plane_quadrature.hpp"
#include "tests/gl/accuracy/accuracy_case.hpp"
#include "tests/gl/accuracy/truth_image.hpp"
#include "tests/support/degree.hpp"

namespace sonard::test {
namespace {

class EdgeAccuracy : public AccuracyTest {};
class DihedralAccuracy : public AccuracyTest {};

INSTANTIATE_TEST_SUITE_P(Accuracy, EdgeAccuracy, all_cases(), case_name);
INSTANTIATE_TEST_SUITE_P(Accuracy, DihedralAccuracy, all_cases(), case_name);

// T6: walls at 8 and 12 m; the near one ends inside a beam, a third from its edge.
TEST_P(EdgeAccuracy, T6TwoHalfPlanes) {
  Scene scene = forward_looking_scene({});
  const auto& edges = scene.settings.aperture.beam_edges_rad;
  constexpr std::size_t edge_beam = 100;
  const double end = (2 * edges[edge_beam] + edges[edge_beam + 1]) / 3;
  const double y = 8 * std::tan(end);
  scene.world = make_world({make_body("near", make_quad(glm::dvec3(8, y, -30), {0, 60, 0}, {0, 0, 60})),
                            make_body("far", make_quad({12, -90, -30}, {0, 180, 0}, {0, 0, 60}))});
  const double limit = scene.settings.aperture.elevation_limit_rad();
  const auto echo = [&](double from, double to, double r1, double r2) {
    const double middle = std::clamp(end, from, to);
    return bench::plane_beam_echo({12, 1, 0, 0, limit}, from, middle, r1, r2) +
           bench::plane_beam_echo({8, 1, 0, 0, limit}, middle, to, r1, r2);
  };
  const render::EchoImage truth = image_of_beams(scene.settings, echo);
  const render::EchoImage image = render(scene);
  expect_within(targets(), measure(image, truth), "two walls");
  const double farthest = 8 / (std::cos(edges[edge_beam]) * std::cos(limit));
  const double nearest = 12 / std::cos(edges[edge_beam + 1]);
  const double step = scene.settings.range.step_m;
  for (int k = static_cast<int>(farthest / step) + 2; k < static_cast<int>(nearest / step) - 1; ++k) {
    ASSERT_EQ(image.at(edge_beam, k), 0) << k;
  }
}

/// The interpolated index at which the echo first crosses `level`, from `from` on in steps of `step`.
template <class Echo>
double crossing(const Echo& echo, int from, int step, double level) {
  const bool begins_above = echo(from) > level;
  int i = from;
  while ((echo(i + step) > level) == begins_above) {
    i += step;
  }
  return i + step * (echo(i) - level) / (echo(i) - echo(i + step));
}

// T7: a thin wall 1.5 m high, 12 m away on a flat bed 5 m below, ends at a bearing. The echo of the open bed
// falls slowly, so the edge of the shadow lies at half of it.
TEST_P(EdgeAccuracy, T7ShadowOfAWall) {
  const double end = -20.1 * degree;
  Scene scene = forward_looking_scene(
      {make_body("bed", make_quad({-200, -200, 0}, {400, 0, 0}, {0, 400, 0})),
       make_body("wall", make_quad(glm::dvec3(12, 12 * std::tan(end), 0), {0, 60, 0}, {0, 0, 1.5}))},
      {900, 0.025, 0, false});
  scene.settings.aperture.vertical_beamwidth_rad = 60 * degree;
  scene.T_world_sonar.position_m.z = 5;
  const WallEndTruth truth{{5, 1.5, 12, 30 * degree}, end};
  const render::EchoImage expected = image_of_beams(
      scene.settings,
      [&](double from, double to, double r1, double r2) { return truth.beam(from, to, r1, r2); });
  const render::EchoImage image = render(scene);
  expect_within(targets(), measure(image, expected), "wall on a bed");
  // Along range: the end of the wall's echo (13.0 m on the axis) and of its shadow (17.857 m), in every beam
  // that is all wall and in which the shadow ends inside the image.
  const auto& edges = scene.settings.aperture.beam_edges_rad;
  double worst_bins = 0;
  for (int beam = 0; beam < image.beams; ++beam) {
    const double psi =
        (edges[static_cast<std::size_t>(beam)] + edges[static_cast<std::size_t>(beam) + 1]) / 2;
    const double far_m = 5 / 3.5 * std::hypot(12 / std::cos(psi), 3.5);
    if (edges[static_cast<std::size_t>(beam) + 1] < end || far_m > 22) {
      continue;
    }
    const int shadow = static_cast<int>((far_m + std::hypot(12 / std::cos(psi), 5)) / 2 / 0.025);
    const auto of = [beam](const render::EchoImage& any) {
      return [&any, beam](int k) { return static_cast<double>(any.at(beam, k)); };
    };
    const double beyond = of(expected)(static_cast<int>(far_m / 0.025) + 10);
    const double before = of(expected)(static_cast<int>(std::hypot(12 / std::cos(psi), 5) / 0.025) - 4);
    for (const auto& [step, level] : {std::pair{1, beyond / 2}, std::pair{-1, before / 2}}) {
      worst_bins = std::max(worst_bins, std::abs(crossing(of(image), shadow, step, level) -
                                                 crossing(of(expected), shadow, step, level)));
    }
  }
  // Across beams: the end of the shadow, on every line that is inside the shadow at that bearing.
  double worst_beams = 0;
  const double first_m = std::hypot(12 / std::cos(end), 5),
               last_m = 5 / 3.5 * std::hypot(12 / std::cos(end), 3.5);
  for (int k = static_cast<int>(first_m / 0.025) + 10; k < static_cast<int>(last_m / 0.025) - 10; ++k) {
    const auto of = [k](const render::EchoImage& any) {
      return [&any, k](int beam) { return static_cast<double>(any.at(beam, k)); };
    };
    const double level = of(expected)(200) / 2;
    worst_beams = std::max(
        worst_beams, std::abs(crossing(of(image), 200, -1, level) - crossing(of(expected), 200, -1, level)));
  }
  std::printf("shadow's edge off by %.3f bins, %.3f beams\n", worst_bins, worst_beams);
  EXPECT_LE(worst_bins, targets().shadow_bins);
  EXPECT_LE(worst_beams, targets().shadow_beams);
}

/// Largest relative difference of a bin to the truth, over three lines around `line`.
double worst_near(const render::EchoImage& image, const render::EchoImage& truth, int beam, int line) {
  double worst = 0;
  for (int k = line - 1; k <= line + 1; ++k) {
    const auto expected = static_cast<double>(truth.at(beam, k));
    worst = std::max(worst, std::abs(static_cast<double>(image.at(beam, k)) / expected - 1));
  }
  return worst;
}

// T8 without multipath: the lines in which double bounces would arrive hold the single bounce only. One bin
// may be off by four times the RMS limit.
TEST_P(DihedralAccuracy, T8DihedralHoldsTheSingleBounce) {
  const double wall_m = 8, depth_m = 3;
  Scene scene =
      forward_looking_scene({make_body("bed", make_quad({-100, -100, -3}, {200, 0, 0}, {0, 200, 0})),
                             make_body("wall", make_quad({8, -60, -3}, {0, 120, 0}, {0, 0, 40}))});
  scene.settings.aperture.vertical_beamwidth_rad = 60 * degree;
  const WallEndTruth truth{{depth_m, 40, wall_m, 30 * degree}, -90 * degree};
  const render::EchoImage expected = image_of_beams(
      scene.settings,
      [&](double from, double to, double r1, double r2) { return truth.beam(from, to, r1, r2); });
  const render::EchoImage image = render(scene);
  expect_within(targets(), measure(image, expected), "dihedral");
  const int line = static_cast<int>(std::hypot(wall_m, depth_m) / 0.02);
  for (const int beam : {127, 128}) {
    EXPECT_LE(worst_near(image, expected, beam, line), 4 * targets().bin_rms) << beam;
  }
}

TEST_P(EdgeAccuracy, T8TrihedralHoldsTheSingleBounce) {
  const double front_m = 8, side_m = 3, depth_m = 3;
  Scene scene =
      forward_looking_scene({make_body("bed", make_quad({-100, -100, -3}, {200, 0, 0}, {0, 200, 0})),
                             make_body("front", make_quad({8, -60, -3}, {0, 63, 0}, {0, 0, 40})),
                             make_body("side", make_quad({-60, 3, -3}, {68, 0, 0}, {0, 0, 40}))});
  scene.settings.aperture.vertical_beamwidth_rad = 60 * degree;
  const double corner = std::atan2(side_m, front_m);
  const WallEndTruth front{{depth_m, 40, front_m, 30 * degree}, -90 * degree};
  const WallEndTruth side{{depth_m, 40, side_m, 30 * degree}, -90 * degree};
  const auto echo = [&](double from, double to, double r1, double r2) {
    const double middle = std::clamp(corner, from, to);
    return front.beam(from, middle, r1, r2) + side.beam(90 * degree - to, 90 * degree - middle, r1, r2);
  };
  const render::EchoImage expected = image_of_beams(scene.settings, echo);
  const render::EchoImage image = render(scene);
  expect_within(targets(), measure(image, expected), "trihedral");
  const auto& edges = scene.settings.aperture.beam_edges_rad;
  int beam = 0;
  while (edges[static_cast<std::size_t>(beam) + 1] > corner) {
    ++beam;
  }
  const int apex =
      static_cast<int>(std::sqrt(front_m * front_m + side_m * side_m + depth_m * depth_m) / 0.02);
  EXPECT_LE(worst_near(image, expected, beam, apex), 4 * targets().bin_rms);
}

}  // namespace
}  // namespace sonard::test
