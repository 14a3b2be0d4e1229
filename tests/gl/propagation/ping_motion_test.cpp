// SPDX-License-Identifier: Apache-2.0
// Motion within a ping (docs/physics.md 2.14): an echo from range r arrives in the sonar's orientation 2 r /
// c after transmission, and from halfway between the sonar's positions at both times.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/pipeline/ping_motion.hpp"
#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using namespace test;

constexpr double range_m = 50.0;
constexpr double turn_rad = 1.98 * degree;  // in all: four spans of half a beam of 1 degree

Pose turned(double yaw_rad, const glm::dvec3& position_m = {}) {
  return {position_m, glm::angleAxis(yaw_rad, glm::dvec3(0, 0, 1))};
}

/// 400 beams of 0.1 degrees; the receive beam is 1 degree wide.
PingRequest request_of(const Pose& at_transmission, const Pose& at_end) {
  PingRequest request;
  request.T_world_sonar = at_transmission;
  request.T_world_sonar_at_end = at_end;
  request.settings.aperture.beam_edges_rad = equal_angle_edges(400, 40 * degree);
  request.settings.aperture.azimuth = Aperture::Azimuth::ideal;
  request.settings.aperture.elevation = Aperture::Elevation::top_hat;
  request.settings.range = {1000, range_m / 1000, 0, false};
  request.settings.sampling.preset = Sampling::Preset::fast;
  return request;
}

/// An upright plate, 6 cm wide and 2 m high.
struct Post {
  double range_m;
  double bearing_rad;

  Body body() const {
    const auto half = 0.03F;
    const auto x = static_cast<float>(range_m);
    Body post = make_body("post at " + std::to_string(range_m),
                          make_quad({x, -half, -1}, {0, 2 * half, 0}, {0, 0, 2}));
    post.T_world_body = turned(bearing_rad);
    return post;
  }
};

World world_of(const std::vector<Post>& posts) {
  World world;
  for (const Post& post : posts) {
    world.bodies.push_back(post.body());
  }
  return world;
}

/// Mean azimuth, rad, of the echoes between two ranges, weighted by intensity.
double azimuth_rad(const EchoImage& image, const PingRequest& request, double from_m, double to_m) {
  const std::vector<double>& edges = request.settings.aperture.beam_edges_rad;
  const double line_m = request.settings.range.step_m;
  double sum = 0;
  double weighted = 0;
  for (int beam = 0; beam < image.beams; ++beam) {
    const auto b = static_cast<std::size_t>(beam);
    for (int line = static_cast<int>(from_m / line_m); line < static_cast<int>(to_m / line_m); ++line) {
      const auto intensity = static_cast<double>(image.at(beam, line));
      sum += intensity;
      weighted += intensity * (edges[b] + edges[b + 1]) / 2;
    }
  }
  EXPECT_GT(sum, 0.0) << "nothing is heard from " << from_m << " m on";
  return weighted / sum;
}

using PingMotion = EngineTest;
INSTANTIATE_TEST_SUITE_P(Propagation, PingMotion, all_engines(), engine_name);

// While the sonar turns to port, each post appears to starboard of its bearing, by the turn at the middle of
// its span. Each of these four posts is in the middle of its span.
TEST_P(PingMotion, EachPostIsHeardWhereTheBeamsAreByThen) {
  const std::vector<Post> posts{
      {6.25, 12 * degree}, {18.75, 5 * degree}, {31.25, -4 * degree}, {43.75, -12 * degree}};
  SonarRenderer renderer(world_of(posts), options());
  const PingRequest request = request_of({}, turned(turn_rad));
  const EchoImage& image = renderer.render_echo(request);
  EXPECT_EQ(renderer.last_statistics().skipped.of(SkipRule::motion_within_ping), 0u);
  for (const Post& post : posts) {
    const double seen = azimuth_rad(image, request, post.range_m - 1, post.range_m + 1);
    EXPECT_NEAR(seen / degree, (post.bearing_rad - turn_rad * post.range_m / range_m) / degree, 0.05);
  }
}

// Elsewhere the bearing is off by no more than the turn in half a span.
TEST_P(PingMotion, NoPostIsOffByMoreThanHalfASpan) {
  std::vector<Post> posts;
  for (int i = 0; i < 12; ++i) {
    posts.push_back({4.0 + 3.7 * i, (15 - 2.5 * i) * degree});
  }
  SonarRenderer renderer(world_of(posts), options());
  const PingRequest request = request_of({}, turned(-turn_rad));
  const EchoImage& image = renderer.render_echo(request);
  for (const Post& post : posts) {
    const double seen = azimuth_rad(image, request, post.range_m - 1, post.range_m + 1);
    EXPECT_NEAR(seen / degree, (post.bearing_rad + turn_rad * post.range_m / range_m) / degree,
                turn_rad / 8 / degree + 0.05)
        << post.range_m;
  }
}

// A flat bed looks the same in all directions, so any seam, gap or duplicate line would show.
TEST_P(PingMotion, TurningOverAFlatBedLeavesTheImageAsItIs) {
  SonarRenderer renderer(
      make_world({make_body("bed", make_quad({-80, -80, -3}, {160, 0, 0}, {0, 160, 0}), 0.3)}), options());
  PingRequest request = request_of({}, {});
  request.settings.aperture.beam_edges_rad = equal_angle_edges(24, 24 * degree);
  request.settings.physical.volume_scattering_db = -60;
  const std::vector<float> at_rest = renderer.render_echo(request).intensity;
  request.T_world_sonar_at_end = turned(turn_rad);
  const EchoImage& turning = renderer.render_echo(request);
  EXPECT_EQ(renderer.last_statistics().skipped.of(SkipRule::unchanged_scene), 0u);
  std::size_t heard = 0;
  for (std::size_t i = 0; i < at_rest.size(); ++i) {
    heard += at_rest[i] > 0.0F ? 1 : 0;
    ASSERT_NEAR(turning.intensity[i], at_rest[i], 0.02F * at_rest[i])
        << "beam " << i / 1000 << " line " << i % 1000;
  }
  EXPECT_GT(heard, at_rest.size() / 2);
}

// The ways out and back differ in length: r = 43.75 m - 0.5 m r / R, R the range of the ping.
TEST_P(PingMotion, RangeIsHalfOfTheWayOutAndBack) {
  RendererOptions all = options();
  all.skip.turn_off(SkipRule::motion_within_ping);
  SonarRenderer renderer(make_world({make_body("wall", make_quad({43.75, -30, -5}, {0, 60, 0}, {0, 0, 10}))}),
                         all);
  PingRequest request = request_of({}, turned(0.0, {1, 0, 0}));
  request.settings.aperture.beam_edges_rad = equal_angle_edges(2, 0.4 * degree);
  const EchoImage& image = renderer.render_echo(request);
  int first = 0;
  while (first < image.bins && image.at(0, first) == 0.0F) {
    ++first;
  }
  EXPECT_NEAR(first * request.settings.range.step_m, 43.75 / (1 + 0.5 / range_m), 0.06);
}

TEST_P(PingMotion, SamePoseWithAnotherMotionIsAnotherEcho) {
  SonarRenderer renderer(world_of({{30, 0}}), options());
  const auto reused = [&](const PingRequest& request) {
    renderer.render_echo(request);
    return renderer.last_statistics().skipped.of(SkipRule::unchanged_scene) == 1;
  };
  EXPECT_FALSE(reused(request_of({}, {})));
  EXPECT_TRUE(reused(request_of({}, {})));
  EXPECT_FALSE(reused(request_of({}, turned(turn_rad))));
  EXPECT_TRUE(reused(request_of({}, turned(turn_rad))));
  EXPECT_FALSE(reused(request_of({}, turned(-turn_rad))));
  EXPECT_FALSE(reused(request_of({}, {}))) << "it has come to rest";
  EXPECT_TRUE(reused(request_of({}, turned(0.1 * degree)))) << "a turn too small to matter is none";
}

TEST_P(PingMotion, OffAndInModePaperThereIsNone) {
  SonarRenderer renderer(world_of({{43.75, 0}}), options());
  PingRequest request = request_of({}, turned(turn_rad));
  request.settings.physical.motion_within_ping = false;
  EXPECT_NEAR(azimuth_rad(renderer.render_echo(request), request, 43, 45), 0, 0.05 * degree);
  request.settings.physical.motion_within_ping = true;
  request.settings.model = Model::paper;
  request.settings.paper.sigmoid_centre = 0.2;
  EXPECT_NEAR(azimuth_rad(renderer.render_echo(request), request, 43, 45), 0, 0.05 * degree);
}

TEST_P(PingMotion, SameBytesForAnyNumberOfThreads) {
  std::vector<std::uint8_t> once;
  for (const unsigned threads : {1U, 3U}) {
    RendererOptions with = options();
    with.threads = threads;
    SonarRenderer renderer(world_of({{10, 0.1}, {30, 0}}), with);
    const std::vector<std::uint8_t> samples = renderer.render_ping(request_of({}, turned(turn_rad))).u8;
    EXPECT_TRUE(once.empty() || samples == once);
    once = samples;
  }
}

// SkipRule::motion_within_ping: on against off.
using MotionRule = EngineTest;
INSTANTIATE_TEST_SUITE_P(Skipping, MotionRule, all_engines(), engine_name);

TEST_P(MotionRule, SkipsTurnsOfLessThanHalfABeamWithinItsBound) {
  RendererOptions off_options = options();
  off_options.skip.turn_off(SkipRule::motion_within_ping);
  const World world = world_of({{48, 0}});
  SonarRenderer renderer(world, options());
  SonarRenderer off(world, off_options);
  const PingRequest request = request_of({}, turned(0.49 * degree));
  const double on_rad = azimuth_rad(renderer.render_echo(request), request, 47, 49);
  EXPECT_EQ(renderer.last_statistics().skipped.of(SkipRule::motion_within_ping), 1u);
  const double off_rad = azimuth_rad(off.render_echo(request), request, 47, 49);
  EXPECT_EQ(off.last_statistics().skipped.of(SkipRule::motion_within_ping), 0u);
  const double beamwidths = std::abs(on_rad - off_rad) / request.settings.aperture.receive_beamwidth_rad;
  EXPECT_GT(beamwidths, 0.35);
  EXPECT_LE(beamwidths, entry_of(SkipRule::motion_within_ping).bound);
}

TEST_P(MotionRule, SonarAtRestHasNothingToSkip) {
  SonarRenderer renderer(world_of({{48, 0}}), options());
  renderer.render_echo(request_of(turned(0.3), turned(0.3)));
  EXPECT_EQ(renderer.last_statistics().skipped.of(SkipRule::motion_within_ping), 0u);
}

TEST(RangeSpans, HoldEveryLineOnceAndAreTwoToFour) {
  for (const double degrees : {0.0, 0.6, 1.2, 1.7, 30.0}) {
    const std::vector<RangeSpan> spans = range_spans({}, turned(degrees * degree), 1001, 1 * degree);
    EXPECT_EQ(spans.size(), degrees < 1 ? 2u : degrees < 1.5 ? 3u : 4u);
    int next = 0;
    for (const RangeSpan& span : spans) {
      EXPECT_EQ(span.first_line, next);
      EXPECT_GT(span.end_line, span.first_line);
      next = span.end_line;
    }
    EXPECT_EQ(next, 1001);
  }
  EXPECT_EQ(range_spans({}, turned(1), 1, 1 * degree).size(), 1u);
}

// q and -q are one orientation.
TEST(RangeSpans, TurnDoesNotDependOnTheSignOfAQuaternion) {
  const Pose a = turned(0.2);
  const Pose b{{}, -turned(0.5).orientation};
  EXPECT_NEAR(turn_between_rad(a, b), 0.3, 1e-12);
  EXPECT_NEAR(turn_between_rad(a, range_spans(a, b, 2, 0.2).back().T_world_sonar), 0.75 * 0.3, 1e-12);
  EXPECT_EQ(turn_between_rad(a, a), 0.0);
}

}  // namespace
}  // namespace sonard::render
