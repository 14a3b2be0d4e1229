// SPDX-License-Identifier: Apache-2.0
// Properties of every image: repeatability, frames, moving bodies, bad input.
#include <cmath>
#include <numeric>

#include "renderer/pipeline/self_test.hpp"
#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using test::EngineTest;
using test::make_body;
using test::make_quad;
using test::make_sphere;
using test::make_world;

PingRequest small_request() {
  PingRequest request;
  request.settings.aperture.beam_edges_rad = equal_sine_edges(64, 60 * degree);
  request.settings.range = {800, 0.02, 1, false};
  request.settings.sampling = Sampling::of_grid(3, 128, 128);
  request.T_world_sonar.position_m.z = 3;
  request.T_world_sonar.orientation = glm::angleAxis(20 * degree, glm::dvec3(0, 1, 0));
  request.seed = 11;
  request.ping_number = 4;
  return request;
}

World bed_and_ball(const glm::dvec3& ball_m) {
  World world = make_world({make_body("bed", make_quad({-50, -50, 0}, {100, 0, 0}, {0, 100, 0}), 0.006),
                            make_body("ball", make_sphere(0.5F, 32), 0.05)});
  world.bodies[1].T_world_body.position_m = ball_m;
  return world;
}

double beam_sum(const EchoImage& image, int from, int to) {
  return std::accumulate(image.intensity.begin() + static_cast<std::ptrdiff_t>(from) * image.bins,
                         image.intensity.begin() + static_cast<std::ptrdiff_t>(to) * image.bins, 0.0);
}

class Image : public EngineTest {};

INSTANTIATE_TEST_SUITE_P(Engines, Image, test::all_engines(), test::engine_name);

TEST_P(Image, SelfTestPasses) {
  EXPECT_LT(run_self_test(options()).error, 0.02);
}

TEST_P(Image, SameRequestGivesTheSameBytes) {
  const PingRequest request = small_request();
  RendererOptions every_time = options();
  every_time.skip.turn_off(SkipRule::unchanged_scene);
  SonarRenderer renderer(bed_and_ball({8, 1, 0.5}), every_time);
  const PingSamples first = renderer.render_ping(request);
  EXPECT_EQ(renderer.render_ping(request).u8, first.u8);
  SonarRenderer other(bed_and_ball({8, 1, 0.5}), options());
  EXPECT_EQ(other.render_ping(request).u8, first.u8);
  PingRequest next = request;
  next.ping_number = 5;
  EXPECT_NE(renderer.render_ping(next).u8, first.u8) << "noise must differ from ping to ping";
  next = request;
  next.seed = 12;
  EXPECT_NE(other.render_ping(next).u8, first.u8);
}

// A daemon renders an unused echo before its first ping.
TEST_P(Image, AnEchoOfAnotherPlaceBeforeChangesNoPing) {
  PingRequest request = small_request();
  request.settings.physical.speckle.kind = SpeckleSettings::Kind::ou;
  PingRequest elsewhere = request;
  elsewhere.T_world_sonar.position_m = {1, 2, 4};
  elsewhere.settings.range.count = 500;
  SonarRenderer warm(bed_and_ball({8, 1, 0.5}), options());
  warm.render_echo(elsewhere);
  SonarRenderer cold(bed_and_ball({8, 1, 0.5}), options());
  for (request.ping_number = 0; request.ping_number < 3; ++request.ping_number) {
    EXPECT_EQ(warm.render_ping(request).u8, cold.render_ping(request).u8) << request.ping_number;
  }
}

TEST_P(Image, TargetToPortIsInTheLowBeams) {
  PingRequest request = small_request();
  request.T_world_sonar.orientation = {1, 0, 0, 0};
  for (const double side : {1.0, -1.0}) {
    SonarRenderer renderer(make_world({[&] {
                             Body ball = make_body("ball", make_sphere(0.5F, 32));
                             ball.T_world_body.position_m = {8, 3 * side, 3};
                             return ball;
                           }()}),
                           options());
    const EchoImage image = renderer.render_echo(request);
    const double port = beam_sum(image, 0, 32);
    const double starboard = beam_sum(image, 32, 64);
    EXPECT_GT(port + starboard, 0);
    EXPECT_EQ(side > 0 ? starboard : port, 0);
  }
}

TEST_P(Image, BodiesMove) {
  SonarRenderer renderer(bed_and_ball({8, 2, 0.5}), options());
  const PingRequest request = small_request();
  const EchoImage before = renderer.render_echo(request);
  EXPECT_FALSE(renderer.set_body_pose("no such body", {}));
  ASSERT_TRUE(renderer.set_body_pose("ball", {{8, -2, 0.5}, {1, 0, 0, 0}}));
  const EchoImage moved = renderer.render_echo(request);
  EXPECT_GT(beam_sum(before, 0, 32), 1.2 * beam_sum(moved, 0, 32));
  EXPECT_GT(beam_sum(moved, 32, 64), 1.2 * beam_sum(before, 32, 64));
  ASSERT_TRUE(renderer.set_body_pose("ball", {{8, 2, 0.5}, {1, 0, 0, 0}}));
  EXPECT_EQ(renderer.render_echo(request).intensity, before.intensity);
}

// A vehicle is hidden from its own sonar in this way.
TEST_P(Image, ABodyOutOfReachChangesNothing) {
  World world = bed_and_ball({8, 2, 0.5});
  world.bodies.push_back(make_body("hull", make_sphere(1.0F, 32)));
  world.bodies.back().T_world_body.position_m = small_request().T_world_sonar.position_m;
  SonarRenderer renderer(world, options());
  SonarRenderer without(bed_and_ball({8, 2, 0.5}), options());
  for (const Sampling::Preset preset : {Sampling::Preset::grid, Sampling::Preset::fast}) {
    PingRequest request = small_request();
    request.settings.sampling.preset = preset;
    request.settings.physical.multipath.level = MultipathSettings::Level::full;
    const EchoImage seen = without.render_echo(request);
    EXPECT_NE(renderer.render_echo(request).intensity, seen.intensity);
    ASSERT_TRUE(renderer.set_body_pose("hull", {{0, 0, -1e6}, {1, 0, 0, 0}}));
    EXPECT_EQ(renderer.render_echo(request).intensity, seen.intensity);
    ASSERT_TRUE(renderer.set_body_pose("hull", request.T_world_sonar));
  }
}

// docs/physics.md 4.3 S2: the image is the same far from the origin and rotated.
TEST_P(Image, FarFromTheOriginTheImageIsTheSame) {
  const PingRequest request = small_request();
  SonarRenderer renderer(bed_and_ball({8, 1, 0.5}), options());
  const EchoImage here = renderer.render_echo(request);
  const float strongest = *std::max_element(here.intensity.begin(), here.intensity.end());
  for (const double shift_m : {1e5, 1e6, 1e7}) {
    const Pose T_far_world{{shift_m, -shift_m, shift_m / 3},
                           glm::angleAxis(0.7, glm::normalize(glm::dvec3(0.2, 0.3, 1)))};
    World world = bed_and_ball({8, 1, 0.5});
    for (Body& body : world.bodies) {
      body.T_world_body = T_far_world * body.T_world_body;
    }
    SonarRenderer far_renderer(world, options());
    PingRequest far_request = request;
    far_request.T_world_sonar = T_far_world * request.T_world_sonar;
    const EchoImage there = far_renderer.render_echo(far_request);
    std::size_t different = 0;
    for (std::size_t i = 0; i < here.intensity.size(); ++i) {
      different += std::abs(there.intensity[i] - here.intensity[i]) > 1e-4F * strongest ? 1 : 0;
    }
    EXPECT_LE(static_cast<double>(different), 1e-3 * static_cast<double>(here.intensity.size())) << shift_m;
  }
}

TEST_P(Image, BadRequestsAreRefusedByName) {
  SonarRenderer renderer(bed_and_ball({8, 1, 0.5}), options());
  const auto refused = [&](auto change) {
    PingRequest request = small_request();
    change(request);
    EXPECT_THROW(renderer.render_ping(request), RequestError);
  };
  refused([](PingRequest& r) { r.settings.range.count = 0; });
  refused([](PingRequest& r) { r.settings.range.step_m = 0; });
  refused([](PingRequest& r) { r.settings.range.step_m = NAN; });
  refused([](PingRequest& r) { r.settings.range.step_m = 1e9; });
  refused([](PingRequest& r) { r.settings.range.compression_log2 = 9; });
  refused([](PingRequest& r) { r.settings.aperture.beam_edges_rad.clear(); });
  refused([](PingRequest& r) { r.settings.sampling = Sampling::of_grid(3, 1 << 20, 512); });
  refused([](PingRequest& r) { r.T_world_sonar.position_m.x = NAN; });
  refused([](PingRequest& r) { r.T_world_sonar.orientation = {0, 0, 0, 0}; });
  refused([](PingRequest& r) { r.T_world_sonar.orientation = {NAN, 0, 0, 0}; });
  EXPECT_NO_THROW(renderer.render_ping(small_request()));
}

// S3: the image of a sonar that lies in a surface or touches it holds no NaN.
TEST_P(Image, GrazingAndTouchingSurfacesStayFinite) {
  SonarRenderer renderer(bed_and_ball({0, 0, 0}), options());
  PingRequest request = small_request();
  for (const double height_m : {0.0, 1e-9, 1e-6, 1e-3, 0.1, 0.5}) {
    request.T_world_sonar.position_m = {0, 0, height_m};
    request.T_world_sonar.orientation = {1, 0, 0, 0};
    for (const float value : renderer.render_echo(request).intensity) {
      ASSERT_TRUE(std::isfinite(value) && value >= 0) << "height " << height_m;
    }
  }
}

TEST_P(Image, ListeningOnlyHearsOnlyNoise) {
  SonarRenderer renderer(bed_and_ball({8, 1, 0.5}), options());
  PingRequest request = small_request();
  request.settings.transmit = false;
  const EchoImage image = renderer.render_echo(request);
  EXPECT_EQ(beam_sum(image, 0, 64), 0);
  const PingSamples samples = renderer.render_ping(request);
  EXPECT_GT(std::accumulate(samples.u8.begin(), samples.u8.end(), 0), 0);
}

// A normal map that tilts every normal by a known angle changes the echo of a wall by the ratio of cosines.
TEST_P(Image, NormalMapTiltsTheNormal) {
  TriangleMesh quad = make_quad({10, 80, -40}, {0, -160, 0}, {0, 0, 80});
  quad.normals.assign(4, {-1, 0, 0});
  quad.tangents.assign(4, {0, 0, 1, 1});  // tangent up: a map pointing along it looks up
  quad.texcoords = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  World world = make_world({make_body("wall", quad)});
  auto map = std::make_shared<NormalMap>();
  map->width_px = map->height_px = 2;
  const double tilt = 50 * degree;
  const auto code = [](double x) { return static_cast<std::uint8_t>(std::lround((x + 1) * 127.5)); };
  for (int i = 0; i < 4; ++i) {
    map->rgb.insert(map->rgb.end(), {code(std::sin(tilt)), code(0), code(std::cos(tilt))});
  }
  const PingRequest request = [] {
    PingRequest r = small_request();
    r.T_world_sonar = {};
    r.settings.aperture.vertical_beamwidth_rad = 2 * degree;
    return r;
  }();
  const double smooth = beam_sum(SonarRenderer(world, options()).render_echo(request), 31, 33);
  world.bodies[0].parts[0].normal_map = map;
  const double mapped = beam_sum(SonarRenderer(world, options()).render_echo(request), 31, 33);
  EXPECT_NEAR(mapped / smooth, std::cos(tilt), 0.01);
}

}  // namespace
}  // namespace sonard::render
