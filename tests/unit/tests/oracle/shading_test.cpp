// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "renderer/scene/primitives.hpp"
#include "tests/oracle/bvh.hpp"
#include "tests/oracle/facets.hpp"
#include "tests/oracle/ray_integrator.hpp"
#include "tests/oracle/shapes.hpp"
#include "tests/oracle/slice_integrator.hpp"
#include "tests/scenes/shapes.hpp"
#include "tests/support/closed_forms.hpp"
#include "tests/support/degree.hpp"
#include "tests/unit/tests/oracle/small_worlds.hpp"

namespace sonard::oracle {

namespace {

/// A sliver of a beam, dead ahead at a wall at 10 m.
const render::SonarSettings sliver = ping(1, 1e-3 * degree, 10 * degree, 50, 12.5);

double wall_echo(const render::World& world, const render::SonarSettings& settings = sliver) {
  const EchoLaw law(settings);
  return total(integrate_slices(Facets(world, {}, law), law));
}

/// Faces the sonar. From there, texture u is y to the left, and v is z.
render::TriangleMesh wall() {
  return quad({10, 0, 0}, {0, -4, 0}, {0, 0, 4});
}

TEST(OracleShading, BilinearTextureRepeats) {
  render::NormalMap map;
  map.width_px = 2;
  map.height_px = 2;
  map.rgb = {0, 0, 0, 255, 0, 0, 0, 255, 0, 255, 255, 255};
  EXPECT_EQ(bilinear(map, {0.25, 0.25}), glm::dvec3(0, 0, 0));
  EXPECT_EQ(bilinear(map, {0.75, 0.25}), glm::dvec3(1, 0, 0));
  EXPECT_EQ(bilinear(map, {0.75, 1.75}), glm::dvec3(1, 1, 1));
  EXPECT_EQ(bilinear(map, {0.5, 0.25}), glm::dvec3(0.5, 0, 0));
  EXPECT_EQ(bilinear(map, {0.5, 0.5}), glm::dvec3(0.5, 0.5, 0.25));
  EXPECT_EQ(bilinear(map, {0.0, 0.25}), glm::dvec3(0.5, 0, 0));  // half of the texel beyond the edge
  EXPECT_EQ(bilinear(map, {-3.0, 0.25}), glm::dvec3(0.5, 0, 0));
}

TEST(OracleShading, VertexNormalsInsteadOfTheTrianglesOwn) {
  // Rotated by beta about z, at psi = 0: cos(phi) is cos(beta) times the wall's value at every elevation.
  const double beta = 40 * degree;
  render::TriangleMesh turned = wall();
  turned.normals.assign(4, glm::vec3(-std::cos(beta), std::sin(beta), 0));
  EXPECT_NEAR(wall_echo(world_of({turned})) / wall_echo(world_of({wall()})), std::cos(beta), 1e-5);
}

TEST(OracleShading, VertexNormalsAreInterpolatedAndMadeUnit) {
  // From -a at one side to +a at the other: dead ahead the normal is perpendicular and has unit length.
  render::TriangleMesh curved = wall();
  for (const glm::vec3& p : curved.positions) {
    const double a = p.y / 4 * 60 * degree;
    curved.normals.emplace_back(-std::cos(a), std::sin(a), 0);
  }
  EXPECT_NEAR(wall_echo(world_of({curved})) / wall_echo(world_of({wall()})), 1.0, 1e-6);
}

TEST(OracleShading, NormalMapTurnsTheNormalInTheFrameOfItsTangent) {
  render::TriangleMesh mapped = wall();
  mapped.normals.assign(4, glm::vec3(-1, 0, 0));
  mapped.texcoords = {{0, 0}, {3, 0}, {3, 3}, {0, 3}};
  mapped.tangents.assign(4, glm::vec4(0, -1, 0, 1));
  render::World world = world_of({mapped});
  const auto map = std::make_shared<render::NormalMap>();
  map->width_px = 1;
  map->height_px = 1;
  map->rgb = {230, 128, 200};
  world.bodies[0].parts[0].normal_map = map;
  // (m.x, m.y, m.z) along tangent, bitangent and normal; at psi = theta = 0 only the normal's share faces the
  // sonar. The bitangent is cross(n, t) = (-1, 0, 0) x (0, -1, 0) = +z: at theta, it adds m.y tan(theta),
  // which cancels over the symmetric fan.
  const glm::dvec3 m = glm::dvec3(230, 128, 200) / 255.0 * 2.0 - 1.0;
  EXPECT_NEAR(wall_echo(world) / wall_echo(world_of({wall()})), m.z / glm::length(m), 1e-5);

  // The upper and the lower half of the fan reveal the sign of the bitangent.
  map->rgb = {128, 230, 200};
  const glm::dvec3 up = glm::dvec3(128, 230, 200) / 255.0 * 2.0 - 1.0;
  const EchoLaw law(ping(1, 1e-3 * degree, 1 * degree, 50, 12.5));
  const render::Pose looking_up{{0, 0, 0}, glm::angleAxis(-20 * degree, glm::dvec3(0, 1, 0))};
  const double mapped_echo = total(integrate_slices(Facets(world, looking_up, law), law));
  const double plain_echo = total(integrate_slices(Facets(world_of({wall()}), looking_up, law), law));
  // d = (cos 20, 0, sin 20), n = -x and t: n.d = -(m.z cos 20 - m.y sin 20).
  const double expected =
      std::abs(up.z * std::cos(20 * degree) - up.y * std::sin(20 * degree)) / glm::length(up);
  EXPECT_NEAR(mapped_echo / plain_echo, expected / std::cos(20 * degree), 1e-4);
}

TEST(OracleShading, RaysAndSlicesReadANormalMapAlike) {
  render::TriangleMesh mapped = wall();
  mapped.normals.assign(4, glm::vec3(-1, 0, 0));
  mapped.texcoords = {{0, 0}, {3, 0}, {3, 3}, {0, 3}};
  mapped.tangents.assign(4, glm::vec4(0, -1, 0, 1));
  render::World world = world_of({mapped});
  const auto map = std::make_shared<render::NormalMap>();
  map->width_px = 4;
  map->height_px = 4;
  for (int i = 0; i < 48; ++i) {
    map->rgb.push_back(static_cast<std::uint8_t>(i % 3 == 2 ? 230 : 90 + (37 * i) % 80));
  }
  world.bodies[0].parts[0].normal_map = map;
  const EchoLaw law(ping(4, 4 * degree, 10 * degree, 200, 12));
  const render::Pose aside{{0, 0, 0}, glm::angleAxis(15 * degree, glm::dvec3(0, 1, 0.5))};
  const Facets facets(world, aside, law);
  const EchoTruth slices = integrate_slices(facets, law);
  RayOptions options;
  options.doublings = 2;
  options.error_rms = 3e-4;
  const EchoTruth rays = integrate_rays(Bvh(facets), law, options);
  EXPECT_GT(total(slices), 0);
  EXPECT_LT(difference(rays, slices).rms, 1e-3);
}

/// The sphere of T4 as triangles, so fine that a facet's sag is a thousandth of a line.
TEST(OracleShading, SphereOfTrianglesIsTheSphere) {
  render::World world = world_of({test::make_ball({0, 0, 0}, 0.5, 512, 256)});
  world.bodies[0].T_world_body.position_m = {8, 0, 0};
  const render::SonarSettings settings = ping(8, 8 * degree, 10 * degree, 40, 10);
  const EchoLaw law(settings);
  SliceOptions options;
  options.error_rms = 1e-3;
  options.error_max = 2e-2;
  const EchoTruth mesh = integrate_slices(Facets(world, {}, law), law, options);
  for (int k = 0; k < settings.range.count; ++k) {
    double measured = 0;
    for (int beam = 0; beam < mesh.beams; ++beam) {
      measured += mesh.at(beam, k);
    }
    const double truth =
        test::sphere_echo(0.5, 8, k * settings.range.step_m, (k + 1) * settings.range.step_m);
    EXPECT_NEAR(measured, truth, 1e-3 * truth) << "line " << k;
  }
}

TEST(OracleShading, RenderersOwnSphereWithSmoothNormals) {
  render::World world = world_of({render::make_sphere(0.5)});
  world.bodies[0].T_world_body.position_m = {8, 0, 0};
  const EchoLaw law(ping(8, 8 * degree, 10 * degree, 10, 10));
  SliceOptions options;
  options.error_rms = 1e-3;
  const double smooth = total(integrate_slices(Facets(world, {}, law), law, options));
  EXPECT_NEAR(smooth / 1.411161e-4, 1.0, 5e-3);  // facets of 7.5 degrees: the outline is 0.2 % small
}

TEST(OracleShading, OneSidedPaperDoesNotSeeBackFaces) {
  render::TriangleMesh away = wall();
  std::swap(away.indices[1], away.indices[2]);
  std::swap(away.indices[4], away.indices[5]);
  render::SonarSettings settings = sliver;
  settings.model = render::Model::paper;
  const double front = wall_echo(world_of({wall()}), settings);
  const double back = wall_echo(world_of({away}), settings);
  EXPECT_GT(front, 0);
  EXPECT_DOUBLE_EQ(front, back);
  settings.paper.two_sided = false;
  const double front_alone = wall_echo(world_of({wall()}), settings);
  const double back_alone = wall_echo(world_of({away}), settings);
  EXPECT_DOUBLE_EQ(std::max(front_alone, back_alone), front);
  EXPECT_EQ(std::min(front_alone, back_alone), 0.0);
  EXPECT_EQ(back_alone, 0.0);
}

}  // namespace

}  // namespace sonard::oracle
