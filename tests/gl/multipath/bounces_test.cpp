// SPDX-License-Identifier: Apache-2.0
// Echoes over two rough surfaces, against the integral over both; and the rule that skips them.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "tests/gl/multipath/multipath_test.hpp"

namespace sonard::render {
namespace {

using namespace test;

class Bounces : public PathTest {
 protected:
  static PingRequest request() {
    PingRequest request = fan_request(240, 60, 16, 0.05);
    request.settings.physical.multipath.most_bounces = 2;
    request.settings.physical.multipath.bounce_loss_db = 0;
    return request;
  }
  static EchoImage without(SonarRenderer& renderer, PingRequest request) {
    request.settings.physical.multipath.most_bounces = 0;
    return renderer.render_echo(request);
  }
};
INSTANTIATE_TEST_SUITE_P(Multipath, Bounces, path_cases(), path_case_name);

struct Plate {
  glm::dvec3 corner, a, b;
  glm::dvec3 normal() const { return glm::normalize(glm::cross(a, b)); }
  double area() const { return glm::length(glm::cross(a, b)); }
  glm::dvec3 at(double x, double y) const { return corner + x * a + y * b; }
  TriangleMesh mesh() const { return make_quad(glm::vec3(corner), glm::vec3(a), glm::vec3(b)); }
};

/// Two plates at right angles, open towards the sonar, which sees both.
const Plate port{{6.8, 0.2, -1}, {0, 0, 2}, {-1, 1, 0}};
const Plate starboard{{6.8, -0.2, -1}, {-1, -1, 0}, {0, 0, 2}};

/// Echo over one plate and then the other: mu cos cos for each, spreading over three legs.
double two_bounces(const Plate& first, const Plate& second, double mu) {
  constexpr int steps = 24;
  double sum = 0;
  const double d_area = first.area() * second.area() / std::pow(steps, 4);
  for (int i = 0; i < steps * steps; ++i) {
    const glm::dvec3 p = first.at((i % steps + 0.5) / steps, (i / steps + 0.5) / steps);
    for (int j = 0; j < steps * steps; ++j) {
      const glm::dvec3 q = second.at((j % steps + 0.5) / steps, (j / steps + 0.5) / steps);
      const glm::dvec3 way = q - p;
      const double leg = glm::length(way), r1 = glm::length(p), r2 = glm::length(q);
      const double cosines = -glm::dot(first.normal(), p / r1) * glm::dot(first.normal(), way / leg) *
                             -glm::dot(second.normal(), way / leg) * -glm::dot(second.normal(), q / r2);
      sum += mu * mu * cosines / (r1 * r1 * leg * leg * r2 * r2) * d_area;
    }
  }
  return sum;
}

TEST_P(Bounces, TwoPlatesHaveTheEnergyOfTheIntegral) {
  constexpr double mu = 0.3;
  ASSERT_GT(glm::dot(port.normal(), -port.corner), 0);
  ASSERT_GT(glm::dot(starboard.normal(), -starboard.corner), 0);
  SonarRenderer renderer(
      make_world({rough_body("port", port.mesh(), mu), rough_body("starboard", starboard.mesh(), mu)}),
      options());
  const EchoImage with = renderer.render_echo(request());
  const EchoImage alone = without(renderer, request());
  const double ours = energy(with, request().settings, 0, 16) - energy(alone, request().settings, 0, 16);
  const double truth = two_bounces(port, starboard, mu) + two_bounces(starboard, port, mu);
  // About 1600 paths. A hundred times as many paths give -0.2 dB.
  std::printf("two plates: %+.2f dB\n", decibels(ours / truth));
  EXPECT_NEAR(decibels(ours / truth), 0, 1.0);
}

TEST_P(Bounces, NothingComesBeforeTheFirstEchoAndALoneSurfaceHasNone) {
  SonarRenderer renderer(make_world({rough_body("port", port.mesh(), 0.3)}), options());
  EXPECT_EQ(renderer.render_echo(request()).intensity, without(renderer, request()).intensity);
  SonarRenderer both(
      make_world({rough_body("port", port.mesh(), 0.3), rough_body("starboard", starboard.mesh(), 0.3)}),
      options());
  const EchoImage image = both.render_echo(request());
  EXPECT_EQ(energy(image, request().settings, 0, 5.85), 0);
  EXPECT_GT(energy(image, request().settings, 8, 12), 0);
}

TEST_P(Bounces, EachSurfaceTakesTheLossThatIsAskedFor) {
  SonarRenderer renderer(
      make_world({rough_body("port", port.mesh(), 0.3), rough_body("starboard", starboard.mesh(), 0.3)}),
      options());
  const auto added = [&](double loss_db) {
    PingRequest asked = request();
    asked.settings.physical.multipath.bounce_loss_db = loss_db;
    const double with = energy(renderer.render_echo(asked), asked.settings, 0, 16);
    return with - energy(without(renderer, asked), asked.settings, 0, 16);
  };
  EXPECT_NEAR(decibels(added(6) / added(0)), -6, 0.02);  // two surfaces, of which one passes sound on
}

// SkipRule::bounces: no path is followed below -15 dB, and the omitted echo is below the rule's bound.
TEST_P(Bounces, DullSurfacesAreSkippedAndCounted) {
  constexpr double mu = 0.00999;  // pi mu = -15.03 dB: of a thousand paths some thirty go on
  const Plate left{{8, 0.1, -5}, {0, 0, 10}, {-6, 6, 0}}, right{{8, -0.1, -5}, {-6, -6, 0}, {0, 0, 10}};
  const World world =
      make_world({rough_body("left", left.mesh(), mu), rough_body("right", right.mesh(), mu)});
  SonarRenderer renderer(world, options());
  const EchoImage skipped = renderer.render_echo(request());
  EXPECT_EQ(renderer.last_statistics().skipped.of(SkipRule::bounces), 1u);
  RendererOptions all = options();
  all.skip.turn_off(SkipRule::bounces);
  SonarRenderer followed(world, all);
  const EchoImage full = followed.render_echo(request());
  EXPECT_EQ(followed.last_statistics().skipped.of(SkipRule::bounces), 0u);
  const double direct = energy(skipped, request().settings, 0, 16);
  const double left_out = energy(full, request().settings, 0, 16) - direct;
  EXPECT_GT(left_out, 0);
  EXPECT_LT(left_out, entry_of(SkipRule::bounces).bound * direct);
}

// Paths are drawn in the sonar's axes, so only rounding moves a few of them.
TEST_P(Bounces, TurnWithWorldAndSonar) {
  const World here =
      make_world({rough_body("port", port.mesh(), 0.3), rough_body("starboard", starboard.mesh(), 0.3)});
  const PingRequest asked = request();
  const EchoImage image = SonarRenderer(here, options()).render_echo(asked);
  const double largest = static_cast<double>(std::ranges::max(image.intensity));
  for (const glm::dquat& turn : {glm::angleAxis(90 * degree, glm::dvec3(0, 0, 1)),
                                 glm::angleAxis(0.7, glm::normalize(glm::dvec3(0.2, 0.3, 1)))}) {
    const Pose T_there_here{{0, 0, 0}, turn};
    World there = here;
    for (Body& body : there.bodies) {
      body.T_world_body = T_there_here * body.T_world_body;
    }
    PingRequest turned = asked;
    turned.T_world_sonar = T_there_here * asked.T_world_sonar;
    const EchoImage other = SonarRenderer(there, options()).render_echo(turned);
    std::size_t differ = 0, echoes = 0;
    for (std::size_t i = 0; i < image.intensity.size(); ++i) {
      const auto a = static_cast<double>(image.intensity[i]), b = static_cast<double>(other.intensity[i]);
      echoes += a > 1e-6 * largest ? 1 : 0;
      differ += std::abs(a - b) > 1e-3 * std::max(a, b) + 1e-6 * largest ? 1 : 0;
    }
    std::printf("turned: %zu of %zu bins differ\n", differ, echoes);
    EXPECT_LE(static_cast<double>(differ), 0.01 * static_cast<double>(echoes));
  }
}

TEST_P(Bounces, AreTheSameForAnyNumberOfThreads) {
  const World world =
      make_world({rough_body("port", port.mesh(), 0.3), rough_body("starboard", starboard.mesh(), 0.3)});
  SonarRenderer one(world, options(1)), three(world, options(3));
  EXPECT_EQ(one.render_echo(request()).intensity, three.render_echo(request()).intensity);
}

}  // namespace
}  // namespace sonard::render
