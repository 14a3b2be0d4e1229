// SPDX-License-Identifier: Apache-2.0
#include "tests/gl/thin_posts/thin_posts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <map>
#include <tuple>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "tests/oracle/slice_integrator.hpp"
#include "tests/scenes/scenes.hpp"
#include "tests/scenes/shapes.hpp"
#include "tests/support/degree.hpp"

namespace sonard::test {
namespace {

constexpr int pings = 16, beams = 8, lines = 1000;
constexpr double beam_rad = 120.0 / 256 * degree;
constexpr double half_length_m = 1.0, above_axis_m = 0.1, bed_mu = 0.1;

/// Around the body's origin.
render::TriangleMesh mesh_of(const ThinPost& post) {
  const glm::dvec3 along = half_length_m * glm::dvec3(0, std::sin(post.lean_rad), std::cos(post.lean_rad));
  if (post.facets > 0) {
    return make_tube(-along, along, 0.5 * post.width_m, post.facets, 1);
  }
  const glm::dvec3 across = post.width_m * glm::dvec3(0, std::cos(post.lean_rad), -std::sin(post.lean_rad));
  return make_quad(-along - 0.5 * across, across, 2.0 * along);
}

/// Body 0 is the post, body 1 the bed, if there is one.
Scene scene_of(const ThinPost& post) {
  Scene scene;
  scene.world.bodies.push_back(make_body("post", mesh_of(post)));
  if (post.bed_m > 0) {
    scene.world.bodies.push_back(
        make_body("bed", make_quad({1, -30, -post.bed_m}, {60, 0, 0}, {0, 60, 0}), bed_mu));
  }
  scene.settings.aperture.beam_edges_rad = render::equal_angle_edges(beams, beams * beam_rad);
  scene.settings.range = {lines, 1.067 * post.distance_m / lines, 0, false};
  scene.settings.physical.absorption_db_per_m = 0;
  return scene;
}

render::Pose pose_at(const ThinPost& post, int ping) {
  return {{post.distance_m + 1.3e-3 * ping, 3.1e-3 * (ping - pings / 2) + 0.7e-3,
           post.bed_m > 0 ? half_length_m - post.bed_m : above_axis_m},
          {1, 0, 0, 0}};
}

/// Echoes of the oracle, [beam * lines + line].
struct Truth {
  std::vector<double> echo, of_bed_alone;
};

std::vector<double> echo_of_oracle(const Scene& scene) {
  const oracle::EchoLaw law(scene.settings);
  oracle::SliceOptions options;
  options.max_corners = 1000;  // no facet of a post hides between two slices
  return oracle::integrate_slices(oracle::Facets(scene.world, scene.T_world_sonar, law), law, options).echo;
}

/// Computed once for all engines and presets.
const Truth& truth_of(const ThinPost& post, int ping) {
  static std::map<std::tuple<double, double, int, double, double, int>, Truth> known;
  Truth& truth = known[{post.distance_m, post.width_m, post.facets, post.lean_rad, post.bed_m, ping}];
  if (truth.echo.empty()) {
    Scene scene = scene_of(post);
    scene.world.bodies[0].T_world_body = pose_at(post, ping);
    truth.echo = echo_of_oracle(scene);
    scene.world.bodies.erase(scene.world.bodies.begin());
    truth.of_bed_alone = post.bed_m > 0 ? echo_of_oracle(scene) : std::vector<double>(truth.echo.size());
  }
  return truth;
}

/// Smallest and largest echo of all pings, relative to the truth.
struct PostEchoes {
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
};

PostEchoes echoes_of(const ThinPost& post, render::EngineKind engine, render::Sampling::Preset preset) {
  Scene scene = scene_of(post);
  scene.settings.sampling.preset = preset;
  render::SonarRenderer renderer(scene.world, {engine});
  PostEchoes found;
  for (int ping = 0; ping < pings; ++ping) {
    const Truth& truth = truth_of(post, ping);
    renderer.set_body_pose("post", pose_at(post, ping));
    const std::vector<float> image = renderer.render_echo(scene.request()).intensity;
    EXPECT_EQ(renderer.engine(), engine);
    double expected = 0, echo = 0;
    for (std::size_t i = 0; i < truth.echo.size(); ++i) {
      if (truth.echo[i] > truth.of_bed_alone[i]) {
        expected += truth.echo[i] - truth.of_bed_alone[i];
        echo += static_cast<double>(image[i]) - truth.of_bed_alone[i];
      }
    }
    found.least = std::min(found.least, echo / expected);
    found.most = std::max(found.most, echo / expected);
  }
  return found;
}

}  // namespace

std::vector<ThinPost> thin_posts(int facets, double lean_rad, double bed_m) {
  return {{30.0, 0.030, facets, lean_rad, bed_m}, {15.0, 0.002, facets, lean_rad, bed_m}};
}

void expect_full_scale(const std::vector<ThinPost>& posts, render::EngineKind engine,
                       render::Sampling::Preset preset, double tolerance) {
  for (const ThinPost& post : posts) {
    const PostEchoes found = echoes_of(post, engine, preset);
    char what[100];
    std::snprintf(what, sizeof what, "%2.0f mm at %2.0f m, %2d facets, leans by %2.0f degrees, %s",
                  1e3 * post.width_m, post.distance_m, post.facets, post.lean_rad / degree,
                  post.bed_m > 0 ? "on a bed" : "open water");
    std::printf("%s: %.4f to %.4f\n", what, found.least, found.most);
    EXPECT_GE(found.least, 1 - tolerance) << what;
    EXPECT_LE(found.most, 1 + tolerance) << what;
  }
}

}  // namespace sonard::test
