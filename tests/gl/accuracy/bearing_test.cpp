// SPDX-License-Identifier: Apache-2.0
// T11: each beam points at the bearing in its table.
#include <algorithm>
#include <cmath>

#include "tests/gl/accuracy/accuracy_case.hpp"

namespace sonard::test {
namespace {

class BearingAccuracy : public AccuracyTest {};

INSTANTIATE_TEST_SUITE_P(Accuracy, BearingAccuracy, all_cases(), case_name);

constexpr int strips = 32;
constexpr int spacing = 8;  // beams between two strips, so that each is alone with its neighbours

std::string strip_name(int i) {
  return "strip" + std::to_string(i);
}

// Strips narrower than a beam, upright in the centre of every eighth beam; eight images cover all beams.
TEST_P(BearingAccuracy, T11StripInTheCentreOfEveryBeam) {
  std::vector<render::Body> bodies;
  for (int i = 0; i < strips; ++i) {
    bodies.push_back(make_body(strip_name(i), make_quad({0, -0.01F, -3}, {0, 0.02F, 0}, {0, 0, 6})));
  }
  const Scene scene = forward_looking_scene(bodies);
  render::SonarRenderer renderer(scene.world, options());
  render::PingRequest request = scene.request();
  request.settings.sampling = {.preset = GetParam().preset};
  const auto& edges = request.settings.aperture.beam_edges_rad;
  double worst = 0, worst_centroid = 0;
  int lost = 0;
  for (int first = 0; first < spacing; ++first) {
    for (int i = 0; i < strips; ++i) {
      const auto beam = static_cast<std::size_t>(first + spacing * i);
      const double psi = (edges[beam] + edges[beam + 1]) / 2;
      ASSERT_TRUE(renderer.set_body_pose(strip_name(i), {{10 * std::cos(psi), 10 * std::sin(psi), 0},
                                                         glm::angleAxis(psi, glm::dvec3(0, 0, 1))}));
    }
    const render::EchoImage& image = renderer.render_echo(request);
    for (int beam = first; beam < image.beams; beam += spacing) {
      double strongest = 0, moment = 0, total = 0;
      int loudest = -spacing;
      for (int b = std::max(0, beam - spacing / 2 + 1); b < std::min(image.beams, beam + spacing / 2); ++b) {
        double echo = 0;
        for (int k = 0; k < image.bins; ++k) {
          echo += static_cast<double>(image.at(b, k));
        }
        moment += (b - beam) * echo;
        total += echo;
        if (echo > strongest) {
          strongest = echo;
          loudest = b;
        }
      }
      if (total == 0) {
        ++lost;
        continue;
      }
      worst = std::max(worst, std::abs(static_cast<double>(loudest - beam)));
      worst_centroid = std::max(worst_centroid, std::abs(moment / total));
    }
  }
  std::printf("strongest beam off by %.0f, centroid by %.4f beams; %d strips lost\n", worst, worst_centroid,
              lost);
  EXPECT_EQ(lost, 0);
  EXPECT_LE(worst, targets().bearing_beams);
  EXPECT_LE(worst_centroid, targets().bearing_centroid);
}

}  // namespace
}  // namespace sonard::test
