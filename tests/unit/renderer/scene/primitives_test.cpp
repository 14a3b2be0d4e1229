// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/primitives.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "renderer/scene/mesh.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using std::numbers::pi;
using test::area_m2;
using test::bounds;
using test::volume_m3;

/// Expects complete attribute arrays, unit normals on the side of the winding, and nothing to repair.
void expect_sound(const TriangleMesh& mesh) {
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  ASSERT_EQ(mesh.texcoords.size(), mesh.positions.size());
  MeshDiagnostics diagnostics;
  const TriangleMesh checked = validated_mesh(mesh, diagnostics);
  EXPECT_EQ(diagnostics.degenerate_triangles, 0U);
  EXPECT_EQ(diagnostics.non_finite_triangles, 0U);
  EXPECT_EQ(diagnostics.bad_normals, 0U);
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const glm::dvec3 facing = glm::normalize(test::area_normal(mesh, t));
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 normal(mesh.normals[mesh.indices[3 * t + k]]);
      ASSERT_NEAR(glm::length(normal), 1.0, 1e-6);
      ASSERT_GT(glm::dot(facing, normal), 0.9) << "triangle " << t;
    }
  }
}

TEST(Box, HasItsAreaVolumeAndExtent) {
  const TriangleMesh mesh = make_box({1.0, 2.0, 3.0});
  expect_sound(mesh);
  EXPECT_EQ(mesh.triangle_count(), 12U);
  EXPECT_NEAR(area_m2(mesh), 22.0, 1e-5);
  EXPECT_NEAR(volume_m3(mesh), 6.0, 1e-5);
  EXPECT_EQ(bounds(mesh).low, glm::dvec3(-0.5, -1.0, -1.5));
  EXPECT_EQ(bounds(mesh).high, glm::dvec3(0.5, 1.0, 1.5));
}

class SphereOfRadius : public testing::TestWithParam<double> {};

TEST_P(SphereOfRadius, StaysWithinTwoMillimetresOfTheTruth) {
  const double r = GetParam();
  const TriangleMesh mesh = make_sphere(r);
  expect_sound(mesh);
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const glm::dvec3 a = test::corner(mesh, 3 * t);
    const glm::dvec3 b = test::corner(mesh, 3 * t + 1);
    const glm::dvec3 c = test::corner(mesh, 3 * t + 2);
    ASSERT_NEAR(glm::length(a), r, 1e-6 * r);
    for (const glm::dvec3& inside : {0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a), (a + b + c) / 3.0}) {
      ASSERT_GT(glm::length(inside), r - 0.002);
    }
  }
  // A facet below the sphere by a sagitta s everywhere loses at most 2 s / r of the area, 3 s / r of the
  // volume.
  EXPECT_NEAR(area_m2(mesh), 4.0 * pi * r * r, 4.0 * pi * r * r * std::max(0.005, 2.0 * 0.002 / r));
  EXPECT_NEAR(volume_m3(mesh), 4.0 / 3.0 * pi * r * r * r, 4.0 * pi * r * r * 0.002 + 0.01 * r * r * r);
  EXPECT_LT(volume_m3(mesh), 4.0 / 3.0 * pi * r * r * r);
  EXPECT_NEAR(bounds(mesh).high.x, r, 1e-6 * r);
  EXPECT_NEAR(bounds(mesh).low.y, -r, 1e-6 * r);
  EXPECT_NEAR(bounds(mesh).high.z, r, 1e-6 * r);
}

INSTANTIATE_TEST_SUITE_P(Radii, SphereOfRadius, testing::Values(0.05, 0.5, 1.0, 5.0, 50.0));

TEST(Sphere, HasSmoothRadialNormals) {
  const TriangleMesh mesh = make_sphere(2.0);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    ASSERT_NEAR(glm::distance(glm::dvec3(mesh.normals[i]), glm::dvec3(mesh.positions[i]) / 2.0), 0.0, 1e-6);
  }
}

TEST(Cylinder, IsTheInscribedPrism) {
  const TriangleMesh mesh = make_cylinder(0.5, 2.0);
  expect_sound(mesh);
  // n quads around, n triangles on each cap.
  const double n = static_cast<double>(mesh.triangle_count()) / 4.0;
  EXPECT_NEAR(volume_m3(mesh), 0.5 * n * std::sin(2.0 * pi / n) * 0.25 * 2.0, 1e-5);
  EXPECT_NEAR(area_m2(mesh), n * std::sin(2.0 * pi / n) * 0.25 + n * 2.0 * 0.5 * std::sin(pi / n) * 2.0,
              1e-5);
  EXPECT_NEAR(volume_m3(mesh), pi * 0.25 * 2.0, 0.005 * pi);
  EXPECT_LT(0.5 * (1.0 - std::cos(pi / n)), 0.002);
  EXPECT_EQ(bounds(mesh).low, glm::dvec3(-0.5, -0.5, -1.0));
  EXPECT_EQ(bounds(mesh).high, glm::dvec3(0.5, 0.5, 1.0));
}

TEST(Cylinder, HasSmoothSidesAndFlatCaps) {
  const TriangleMesh mesh = make_cylinder(0.5, 2.0);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3& n = mesh.normals[i];
    const glm::vec3& p = mesh.positions[i];
    if (n.z == 0.0F) {
      EXPECT_NEAR(glm::distance(n, glm::vec3(2.0F * p.x, 2.0F * p.y, 0.0F)), 0.0, 1e-6);
    } else {
      EXPECT_EQ(n, glm::vec3(0.0F, 0.0F, p.z > 0.0F ? 1.0F : -1.0F));
    }
  }
}

TEST(Cylinder, OfFiveMetresIsFineEnough) {
  const double n = static_cast<double>(make_cylinder(5.0, 1.0).triangle_count()) / 4.0;
  EXPECT_LT(5.0 * (1.0 - std::cos(pi / n)), 0.002);
}

TEST(Cone, HasItsTipUpAndNormalsAcrossItsSide) {
  const TriangleMesh mesh = make_cone(0.5, 2.0);
  expect_sound(mesh);
  EXPECT_NEAR(volume_m3(mesh), pi * 0.25 * 2.0 / 3.0, 0.003);
  EXPECT_NEAR(area_m2(mesh), pi * 0.25 + pi * 0.5 * std::hypot(0.5, 2.0), 0.02);
  EXPECT_EQ(bounds(mesh).low, glm::dvec3(-0.5, -0.5, -1.0));
  EXPECT_EQ(bounds(mesh).high, glm::dvec3(0.5, 0.5, 1.0));
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3& n = mesh.normals[i];
    if (n.z >= 0.0F) {  // the side: a step down it goes 0.5 out and 2 down
      EXPECT_NEAR(0.5F * std::hypot(n.x, n.y) - 2.0F * n.z, 0.0F, 1e-6F);
    } else {
      EXPECT_EQ(n, glm::vec3(0.0F, 0.0F, -1.0F));
    }
  }
}

TEST(Capsule, IsACylinderBetweenHalfSpheres) {
  const TriangleMesh mesh = make_capsule(0.5, 2.0);
  expect_sound(mesh);
  EXPECT_NEAR(volume_m3(mesh), pi * 0.25 * 2.0 + 4.0 / 3.0 * pi * 0.125, 0.02);
  EXPECT_NEAR(area_m2(mesh), 2.0 * pi * 0.5 * 2.0 + 4.0 * pi * 0.25, 0.05);
  EXPECT_NEAR(bounds(mesh).high.z, 1.5, 1e-6);
  EXPECT_NEAR(bounds(mesh).low.z, -1.5, 1e-6);
  EXPECT_NEAR(bounds(mesh).high.x, 0.5, 1e-6);
}

TEST(Ellipsoid, HasItsVolumeAndNormals) {
  const TriangleMesh mesh = make_ellipsoid({1.0, 2.0, 0.5});
  expect_sound(mesh);
  EXPECT_NEAR(volume_m3(mesh), 4.0 / 3.0 * pi, 0.02);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    // The gradient of x^2/a^2 + y^2/b^2 + z^2/c^2.
    const glm::dvec3 p(mesh.positions[i]);
    const glm::dvec3 expected = glm::normalize(glm::dvec3(p.x, p.y / 4.0, p.z / 0.25));
    ASSERT_NEAR(glm::distance(glm::dvec3(mesh.normals[i]), expected), 0.0, 1e-5);
  }
}

TEST(Plane, FacesItsNormal) {
  const TriangleMesh flat = make_plane({4.0, 3.0}, {0.0, 0.0, 2.0});
  expect_sound(flat);
  EXPECT_NEAR(area_m2(flat), 12.0, 1e-5);
  EXPECT_EQ(bounds(flat).low, glm::dvec3(-2.0, -1.5, 0.0));
  EXPECT_EQ(flat.normals[0], glm::vec3(0, 0, 1));

  // z turned onto x: the side that was along x points down, y stays.
  const TriangleMesh wall = make_plane({4.0, 3.0}, {1.0, 0.0, 0.0});
  EXPECT_NEAR(bounds(wall).high.x, 0.0, 1e-6);
  EXPECT_NEAR(bounds(wall).high.z, 2.0, 1e-6);
  EXPECT_NEAR(bounds(wall).high.y, 1.5, 1e-6);
  EXPECT_NEAR(glm::distance(wall.normals[0], glm::vec3(1, 0, 0)), 0.0, 1e-6);

  const TriangleMesh ceiling = make_plane({4.0, 3.0}, {0.0, 0.0, -1.0});
  expect_sound(ceiling);
  EXPECT_EQ(ceiling.normals[0], glm::vec3(0, 0, -1));
}

TEST(Shapes, OfOneSizeZeroAreFlat) {
  for (const glm::dvec3 size : {glm::dvec3(0, 2, 3), glm::dvec3(2, 0, 3), glm::dvec3(2, 3, 0)}) {
    const TriangleMesh plate = make_box(size);
    expect_sound(plate);
    EXPECT_NEAR(area_m2(plate), 6.0, 1e-9) << "one sheet, which echoes on both sides";
  }
  for (const TriangleMesh& disc : {make_cylinder(1.0, 0.0), make_cone(1.0, 0.0)}) {
    expect_sound(disc);
    EXPECT_NEAR(area_m2(disc), pi, 0.02);
  }
  EXPECT_NEAR(bounds(make_capsule(1.0, 0.0)).high.z, 1.0, 1e-9);
}

TEST(Shapes, WithoutASurfaceSaySo) {
  EXPECT_THROW(make_box({0.0, 2.0, 0.0}), ShapeOfNothing);
  EXPECT_THROW(make_sphere(0.0), ShapeOfNothing);
  EXPECT_THROW(make_cylinder(0.0, 1.0), ShapeOfNothing);
  EXPECT_THROW(make_ellipsoid({1.0, 0.0, 1.0}), ShapeOfNothing);
  EXPECT_THROW(make_plane({0.0, 1.0}, {0.0, 0.0, 1.0}), ShapeOfNothing);
}

TEST(Shapes, RefuseImpossibleSizes) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(make_box({1.0, -1.0, 1.0}), WorldError);
  EXPECT_THROW(make_sphere(-1.0), WorldError);
  EXPECT_THROW(make_sphere(nan), WorldError);
  EXPECT_THROW(make_cylinder(1.0, std::numeric_limits<double>::infinity()), WorldError);
  EXPECT_THROW(make_capsule(0.0, 1.0), WorldError);
  EXPECT_THROW(make_ellipsoid({1.0, 1.0, -1.0}), WorldError);
  EXPECT_THROW(make_plane({1.0, 1.0}, {0.0, 0.0, 0.0}), WorldError);
  EXPECT_THROW(make_plane({0.0, 1.0}, {0.0, 0.0, 1.0}), WorldError);
}

}  // namespace
}  // namespace sonard::render
