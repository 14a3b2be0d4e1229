// SPDX-License-Identifier: Apache-2.0
// S4, S5, S14 and S19 of docs/physics.md 4.3: broken meshes, soup, thin things, ties, a full bin.
#include <array>
#include <cstdint>
#include <limits>
#include <random>

#include "renderer/scene/mesh.hpp"
#include "tests/gl/stability/stability_test.hpp"

namespace sonard::render {
namespace {

using namespace test;

SONARD_STABILITY_SUITE(Geometry);

World harbour_with_ball(TriangleMesh ball) {
  World world = small_harbour();
  world.bodies[1].parts[0].mesh = std::make_shared<const TriangleMesh>(std::move(ball));
  return world;
}

void add_triangle(TriangleMesh& mesh, const std::array<glm::vec3, 3>& corners) {
  for (const glm::vec3& corner : corners) {
    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    mesh.positions.push_back(corner);
    if (!mesh.normals.empty()) {
      mesh.normals.emplace_back(0, 0, 1);
    }
  }
}

// As in a loader, the mesh passes validated_mesh().
TEST_P(Geometry, S4DegenerateAndDuplicateTrianglesChangeNothing) {
  TriangleMesh broken = make_sphere(0.5F, 32);
  const std::size_t good = broken.indices.size();
  for (std::uint32_t i = 100; i < 130; ++i) {
    broken.indices.insert(broken.indices.end(), {i, i, i + 1});  // a repeated corner
  }
  for (int i = 0; i < 20; ++i) {  // no area, far outside the ball
    const auto x = static_cast<float>(i);
    add_triangle(broken, {glm::vec3(x, 0, 0), glm::vec3(x + 1, 0, 0), glm::vec3(x + 2, 0, 0)});
  }
  for (std::size_t i = 0; i < 300; ++i) {
    broken.indices.push_back(broken.indices[good - 1200 + i]);  // duplicates
  }
  for (std::size_t i = 0; i < broken.normals.size(); i += 3) {
    broken.normals[i] *= i % 2 == 0 ? 1e-3F : 1e3F;
  }
  MeshDiagnostics diagnostics;
  const TriangleMesh repaired = validated_mesh(broken, diagnostics);
  EXPECT_EQ(diagnostics.degenerate_triangles, 50U);
  EXPECT_EQ(repaired.indices.size(), good + 300);

  const EchoImage clean = SonarRenderer(small_harbour(), options()).render_echo(quiet_request());
  const EchoImage image = SonarRenderer(harbour_with_ball(repaired), options()).render_echo(quiet_request());
  EXPECT_TRUE(is_sane(image));
  EXPECT_LE(different_share(clean, image, 1e-4), silhouette_share);
}

TEST_P(Geometry, S4ZeroOrMissingNormalsBecomeGeometricOnes) {
  const EchoImage clean = SonarRenderer(small_harbour(), options()).render_echo(quiet_request());
  TriangleMesh zero = make_sphere(0.5F, 32);
  std::fill(zero.normals.begin(), zero.normals.end(), glm::vec3(0.0F));
  TriangleMesh missing = make_sphere(0.5F, 32);
  missing.normals.clear();
  for (const TriangleMesh& mesh : {zero, missing}) {
    MeshDiagnostics diagnostics;
    const TriangleMesh repaired = validated_mesh(mesh, diagnostics);
    EXPECT_EQ(diagnostics.bad_normals, repaired.normals.size());
    const EchoImage image =
        SonarRenderer(harbour_with_ball(repaired), options()).render_echo(quiet_request());
    EXPECT_TRUE(is_sane(image));
    // 64 facets around: their normals differ from the ball's by up to 2.8 degrees.
    EXPECT_NEAR(sum(image) / sum(clean), 1.0, 5e-3);
  }
}

// A normal map on a mesh that cannot carry one changes nothing.
TEST_P(Geometry, S4NormalMapWithoutTangentsOrTextureCoordinatesIsLeftOut) {
  auto map = std::make_shared<NormalMap>();
  map->width_px = map->height_px = 1;
  map->rgb = {255, 128, 128};  // along the tangent: it would darken all surfaces that face the sonar
  const TriangleMesh plain = make_sphere(0.5F, 32);
  const std::size_t count = plain.positions.size();
  std::vector<TriangleMesh> meshes(3, plain);
  meshes[1].texcoords.assign(count, glm::vec2(0.5F));
  meshes[2].tangents.assign(count, glm::vec4(0, 0, 1, 1));
  const EchoImage clean = SonarRenderer(small_harbour(), options()).render_echo(quiet_request());
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    World world = harbour_with_ball(meshes[i]);
    world.bodies[1].parts[0].normal_map = map;
    const EchoImage image = SonarRenderer(world, options()).render_echo(quiet_request());
    EXPECT_EQ(image.intensity, clean.intensity) << "mesh " << i;
  }
}

TEST_P(Geometry, S5PrimitivesThatAreNoNumbersAreRejectedAndOthersUnaffected) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float inf = std::numeric_limits<float>::infinity();
  constexpr float denormal = std::numeric_limits<float>::denorm_min();
  TriangleMesh broken = make_sphere(0.5F, 32);
  for (const float bad : {nan, inf, -inf, 1e38F, -1e38F}) {
    add_triangle(broken, {glm::vec3(bad, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)});
    add_triangle(broken, {glm::vec3(0, 0, bad), glm::vec3(bad, 1, 0), glm::vec3(bad, bad, bad)});
  }
  add_triangle(broken, {glm::vec3(0), glm::vec3(denormal, 0, 0), glm::vec3(0, denormal, 0)});
  MeshDiagnostics diagnostics;
  const TriangleMesh repaired = validated_mesh(broken, diagnostics);
  EXPECT_EQ(diagnostics.non_finite_triangles, 10U);
  EXPECT_EQ(diagnostics.degenerate_triangles, 1U);
  const EchoImage clean = SonarRenderer(small_harbour(), options()).render_echo(quiet_request());
  const EchoImage image = SonarRenderer(harbour_with_ball(repaired), options()).render_echo(quiet_request());
  EXPECT_LE(different_share(clean, image, 1e-6), silhouette_share);
}

// Finite coordinates of the size of the solar system are out of range, so they change nothing.
TEST_P(Geometry, S5SurfacesAsFarAsCoordinatesGoAreOutOfRange) {
  const EchoImage clean = SonarRenderer(small_harbour(), options()).render_echo(quiet_request());
  World world = small_harbour();
  world.bodies.push_back(
      make_body("sky", make_quad({9e11F, -9e11F, -9e11F}, {0, 1.8e12F, 0}, {0, 0, 1.8e12F})));
  TriangleMesh denormals = make_sphere(0.5F, 4);
  for (glm::vec3& p : denormals.positions) {
    p *= 1e-39F;  // not validated: it would be dropped
  }
  world.bodies.push_back(make_body("speck", denormals));
  world.bodies.back().T_world_body.position_m = {5, 0, 1};
  const EchoImage image = SonarRenderer(world, options()).render_echo(quiet_request());
  EXPECT_TRUE(is_sane(image));
  // Surfaces beyond the range can still change the slices of a beam, within the preset's accuracy.
  const double allowed = GetParam() == Way::cpu_slices ? 1e-3 : 1e-4;
  EXPECT_LE(different_share(clean, image, allowed), silhouette_share);
}

// Eight bits hold no NaN, but the texels can cancel to no normal at all.
TEST_P(Geometry, S5NormalMapWhoseTexelsCancelStaysFinite) {
  auto map = std::make_shared<NormalMap>();
  map->width_px = map->height_px = 2;
  map->rgb = {0, 0, 0, 255, 255, 255, 255, 255, 255, 0, 0, 0};
  World world = small_harbour();
  TriangleMesh ball = make_sphere(0.5F, 32);
  ball.texcoords.assign(ball.positions.size(), glm::vec2(0.0F));
  for (std::size_t i = 0; i < ball.positions.size(); ++i) {
    ball.texcoords[i] = 50.0F * glm::vec2(ball.positions[i]);
  }
  ball.tangents.assign(ball.positions.size(), glm::vec4(0, 0, 1, 1));  // along the normal at the poles
  world.bodies[1].parts[0].mesh = std::make_shared<const TriangleMesh>(ball);
  world.bodies[1].parts[0].normal_map = map;
  SonarRenderer renderer(world, options());
  EXPECT_TRUE(is_sane(renderer.render_echo(quiet_request())));
}

/// `count` right triangles of legs `leg_m`, thrown at random into a slab across x, from 4 m to 8 m.
TriangleMesh soup(int count, double leg_m) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 corner(4 + 4 * unit(engine), 8 * unit(engine) - 4, 3 * unit(engine) - 1.5);
    const glm::dvec3 a = glm::normalize(glm::dvec3(normal(engine), normal(engine), normal(engine)));
    const glm::dvec3 random(normal(engine), normal(engine), normal(engine));
    const glm::dvec3 b = glm::normalize(random - a * glm::dot(a, random));
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.emplace_back(corner);
    mesh.positions.emplace_back(corner + leg_m * a);
    mesh.positions.emplace_back(corner + leg_m * b);
    mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2});
  }
  return mesh;
}

// Triangles of random direction and density n hide each other like fog: with k = n times half their area, a
// ray meets its first at s with density k exp(-k s), and E[cos phi | met] = 2/3. So per steradian and metre
// the echo is 2/3 mu k exp(-k (r - r0)) / r^2. The test has a tenth of the triangles of the design, to save
// time.
TEST_P(Geometry, S14SoupOfAMillionSubpixelTrianglesFadesLikeFog) {
  constexpr int count = 1'000'000;
  constexpr double leg_m = 0.012;
  SonarRenderer renderer(make_world({make_body("soup", soup(count, leg_m), full_mu)}), options());
  PingRequest request = level_request();
  request.settings.aperture.beam_edges_rad = equal_angle_edges(32, 30 * degree);
  request.settings.range = {400, 0.02, 0, false};
  if (request.settings.sampling.preset == Sampling::Preset::grid) {
    request.settings.sampling = Sampling::of_grid(1, 256, 256);
  }
  const EchoImage image = renderer.render_echo(request);
  ASSERT_TRUE(is_sane(image));
  const double k = count / (4.0 * 8.0 * 3.0) * (leg_m * leg_m / 2) / 2;
  const double limit = request.settings.aperture.elevation_limit_rad();
  // Away from the near face, which triangles cross: two layers of a metre. r0 is 4 m over the cosines.
  for (const double from_m : {5.0, 6.5}) {
    double truth = 0;
    constexpr int steps = 60;
    for (int i = 0; i < steps; ++i) {
      const double psi = 30 * degree * ((i + 0.5) / steps - 0.5);
      for (int j = 0; j < steps; ++j) {
        const double theta = 2 * limit * ((j + 0.5) / steps - 0.5);
        for (int l = 0; l < steps; ++l) {
          const double r = from_m + (l + 0.5) / steps;
          const double s = r - 4 / (std::cos(psi) * std::cos(theta));
          truth += 2.0 / 3 * full_mu * k * std::exp(-k * s) / (r * r) * std::cos(theta) / steps *
                   (30 * degree / steps) * (2 * limit / steps);
        }
      }
    }
    double measured = 0;
    for (int beam = 0; beam < image.beams; ++beam) {
      for (int line = static_cast<int>(std::lround(from_m / 0.02)); line < std::lround((from_m + 1) / 0.02);
           ++line) {
        measured += static_cast<double>(image.at(beam, line));
      }
    }
    EXPECT_NEAR(measured / truth, 1.0, 0.05) << from_m << " m";
  }
}

// A strip s samples wide is found with probability min(1, s) (tests/gl/stability/README.md, S14). Slices miss
// nothing along the elevation. Across it they are a degree wide at most, and thin upright objects divide
// them.
TEST_P(Geometry, S14ThinStripsAreFoundAsOftenAsTheirWidthSays) {
  const bool slices = GetParam() == Way::cpu_slices;
  PingRequest request = level_request();
  request.settings.aperture.beam_edges_rad = equal_angle_edges(8, 40 * degree);
  request.settings.sampling = slices ? Sampling{} : Sampling::of_grid(1, 64, 64);
  const double column = 2 * std::tan(20 * degree) / 64;
  // The view is as high as the elevation limit is at its sides.
  const double row =
      2 * std::tan(request.settings.aperture.elevation_limit_rad()) / std::cos(20 * degree) / 64;
  constexpr int places = 40;  // over one sample, off its centre
  for (const bool upright : {true, false}) {
    const double sample = upright ? column : row;
    for (const double s : {0.1, 0.5, 1.01}) {
      SonarRenderer renderer(strip(10 * s * sample, 0, upright), options());
      int found = 0;
      double echo = 0;
      for (int i = 0; i < places; ++i) {
        const double aside = 10 * sample * (3 + (i + 0.5) / places);
        const Pose pose{upright ? glm::dvec3(10, aside, 0) : glm::dvec3(10, 0, aside), {1, 0, 0, 0}};
        ASSERT_TRUE(renderer.set_body_pose("strip", pose));
        const EchoImage image = renderer.render_echo(request);
        found += sum(image) > 0 ? 1 : 0;
        echo += sum(image) / places;
      }
      if (slices) {
        const double samples_wide = upright ? s * sample / std::tan(1 * degree) : 1.0;
        const double expected = std::min(1.0, samples_wide) * places;
        EXPECT_GE(found, expected - 1) << (upright ? "upright, " : "level, ") << s;
      } else {
        const double expected = std::min(1.0, s) * places;
        EXPECT_NEAR(found, expected, s < 1 ? 1 : 0) << (upright ? "upright, " : "level, ") << s;
      }
      EXPECT_GT(echo, 0);
    }
  }
}

// Two walls of the same triangles in the same place: the first of the world echoes. On a fixed grid of the
// CPU each packet of rays decides for itself, but always in the same way.
TEST_P(Geometry, S14TieBetweenCoplanarSurfaces) {
  const TriangleMesh quad = make_quad({0, -20, -20}, {0, 40, 0}, {0, 0, 40});
  Body strong = make_body("strong", quad, 0.2);
  strong.T_world_body.position_m = {9, 0, 0};
  Body weak = make_body("weak", quad, 0.1);
  weak.T_world_body = strong.T_world_body;
  const auto heard = [&](const std::vector<Body>& bodies) {
    return SonarRenderer(make_world(bodies), options()).render_echo(level_request());
  };
  const EchoImage only_strong = heard({strong});
  const EchoImage only_weak = heard({weak});
  const EchoImage strong_first = heard({strong, weak});
  const EchoImage weak_first = heard({weak, strong});
  if (GetParam() != Way::cpu_grid) {
    EXPECT_EQ(strong_first.intensity, only_strong.intensity);
    EXPECT_EQ(weak_first.intensity, only_weak.intensity);
    return;
  }
  EXPECT_EQ(heard({strong, weak}).intensity, strong_first.intensity);
  EXPECT_EQ(heard({weak, strong}).intensity, weak_first.intensity);
  for (std::size_t i = 0; i < only_strong.intensity.size(); ++i) {
    for (const EchoImage& both : {strong_first, weak_first}) {
      ASSERT_LE(both.intensity[i], only_strong.intensity[i] * (1 + 1e-5F)) << i;
      ASSERT_GE(both.intensity[i], only_weak.intensity[i] * (1 - 1e-5F)) << i;
    }
  }
}

// The same wall in two triangulations: each sample may see either, but always the same one.
TEST_P(Geometry, S14FightOfCoplanarTriangulationsIsRepeatable) {
  TriangleMesh other = make_quad({0, -20, -20}, {0, 40, 0}, {0, 0, 40});
  other.indices = {0, 1, 3, 1, 2, 3};
  World world = make_world({make_body("one", make_quad({0, -20, -20}, {0, 40, 0}, {0, 0, 40}), 0.2),
                            make_body("other", other, 0.1)});
  for (Body& body : world.bodies) {
    body.T_world_body = {{9, 0.3, 0.2}, glm::angleAxis(0.4, glm::normalize(glm::dvec3(0.1, 0.3, 1)))};
  }
  SonarRenderer renderer(world, options());
  const EchoImage first = renderer.render_echo(level_request());
  EXPECT_TRUE(is_sane(first));
  EXPECT_EQ(renderer.render_echo(level_request()).intensity, first.intensity);
  EXPECT_EQ(SonarRenderer(world, options()).render_echo(level_request()).intensity, first.intensity);
  World strong = world;
  strong.bodies.resize(1);
  const double most = sum(SonarRenderer(strong, options()).render_echo(level_request()));
  EXPECT_LE(sum(first), most * (1 + 1e-6));
  EXPECT_GE(sum(first), most / 2 * (1 - 1e-6));
}

TEST_P(Geometry, S14OpenMeshFromBehind) {
  // make_quad's normal is a x b: +x here, away from a sonar at the origin.
  const World away = make_world({make_body("wall", make_quad({9, -20, -20}, {0, 40, 0}, {0, 0, 40}), 0.1)});
  const World facing = make_world({make_body("wall", make_quad({9, -20, -20}, {0, 0, 40}, {0, 40, 0}), 0.1)});
  SonarRenderer from_behind(away, options());
  SonarRenderer from_before(facing, options());
  PingRequest request = level_request();
  const EchoImage front = from_before.render_echo(request);
  EXPECT_GT(sum(front), 0);
  EXPECT_NEAR(sum(from_behind.render_echo(request)) / sum(front), 1.0, 1e-6);
  request.settings.model = Model::paper;
  EXPECT_NEAR(sum(from_behind.render_echo(request)) / sum(from_before.render_echo(request)), 1.0, 1e-6);
  request.settings.paper.two_sided = false;
  EXPECT_GT(sum(from_before.render_echo(request)), 0);
  EXPECT_EQ(sum(from_behind.render_echo(request)), 0);
}

// 2^18 samples, as points, of the strongest possible surface in the only bin of the only beam. With cos phi
// = cos theta cos psi the integral over the fan is 2 sin(psi_m) (theta_m + sin(theta_m) cos(theta_m)).
TEST_P(Geometry, S19AQuarterOfAMillionSamplesInOneBin) {
  PingRequest request = level_request();
  request.settings.aperture.beam_edges_rad = equal_angle_edges(1, 60 * degree);
  request.settings.range = {1, 100.0, 0, false};
  request.settings.sampling = Sampling::of_grid(1, 512, 512);  // slices have no points
  request.settings.sampling.footprint = false;
  const World world =
      make_world({make_body("wall", make_quad({9, -50, -50}, {0, 100, 0}, {0, 0, 100}), full_mu)});
  const double limit = request.settings.aperture.elevation_limit_rad();
  const double truth =
      full_mu * 2 * std::sin(30 * degree) * (limit + std::sin(limit) * std::cos(limit)) / (50.0 * 50.0);
  SonarRenderer renderer(world, options());
  EXPECT_NEAR(static_cast<double>(renderer.render_echo(request).at(0, 0)) / truth, 1.0, 1e-3);
  EXPECT_GE(renderer.last_statistics().samples, 200'000U);  // the corners of the view are out of the fan
  request.settings.sampling = sampling(512, 512);
  request.settings.model = Model::paper;
  request.settings.paper.sigmoid_centre = 0;
  const float mean = renderer.render_echo(request).at(0, 0);
  EXPECT_GT(mean, 0.99F);
  EXPECT_LE(mean, 1.0F);
}

}  // namespace
}  // namespace sonard::render
