// SPDX-License-Identifier: Apache-2.0
#include "tests/oracle/bvh.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/oracle/shapes.hpp"
#include "tests/scenes/shapes.hpp"
#include "tests/support/degree.hpp"
#include "tests/unit/tests/oracle/small_worlds.hpp"

namespace sonard::oracle {

namespace {

const EchoLaw law(ping(1, 170 * degree, 170 * degree, 1, 1000));

glm::dvec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dvec3(std::abs(normal(random)) + 0.3, normal(random), normal(random)));
}

/// Range to the triangle by solving for the intersection with its plane and the barycentric coordinates
/// there.
double range_by_cramer(const Facet& facet, const glm::dvec3& d) {
  const glm::dvec3 e1 = facet.corners[1] - facet.corners[0];
  const glm::dvec3 e2 = facet.corners[2] - facet.corners[0];
  const double det = glm::dot(e1, glm::cross(d, e2));
  const glm::dvec3 s = -facet.corners[0];
  const double u = glm::dot(s, glm::cross(d, e2)) / det;
  const double v = glm::dot(d, glm::cross(s, e1)) / det;
  const double r = glm::dot(e2, glm::cross(s, e1)) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && r > 0 ? r : INFINITY;
}

TEST(OracleBvh, TriangleSoupAsTestingEveryTriangle) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> near(-1, 1), far(-10, 10);
  render::TriangleMesh soup;
  for (std::uint32_t i = 0; i < 1500; ++i) {
    const glm::dvec3 centre(far(random) + 12, far(random), far(random));
    for (int corner = 0; corner < 3; ++corner) {
      soup.positions.emplace_back(centre + glm::dvec3(near(random), near(random), near(random)));
      soup.indices.push_back(3 * i + static_cast<std::uint32_t>(corner));
    }
  }
  const Facets facets(world_of({soup}), {}, law);
  const Bvh bvh(facets);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const glm::dvec3 d = random_direction(random);
    double nearest = INFINITY;
    for (const Facet& facet : facets.all()) {
      nearest = std::min(nearest, range_by_cramer(facet, d));
    }
    const double found = bvh.find(d).range_m;
    if (nearest == INFINITY) {
      EXPECT_EQ(found, INFINITY);
    } else {
      EXPECT_NEAR(found, nearest, 1e-9);
      ++hits;
    }
  }
  EXPECT_GT(hits, 1000);
}

TEST(OracleBvh, NoRaySlipsThroughAnEdgeOrACorner) {
  // From inside a closed ball every ray hits, even through its corners and the middles of its edges.
  const Facets facets(world_of({test::make_ball({0.1, 0.05, -0.02}, 2.0, 24, 12)}), {}, law);
  const Bvh bvh(facets);
  for (const Facet& facet : facets.all()) {
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec3& a = facet.corners[i];
      const glm::dvec3& b = facet.corners[(i + 1) % 3];
      for (const glm::dvec3& target : {a, (a + b) / 2.0, 0.3 * a + 0.7 * b}) {
        EXPECT_NEAR(bvh.find(glm::normalize(target)).range_m, glm::length(target), 1e-9);
      }
    }
  }
}

TEST(OracleBvh, OfTwoFacetsInOnePlaceTheFirstIsHit) {
  const render::TriangleMesh wall = quad({5, 0.5, 0.2}, {0, 3, 0}, {0, 0, 3});
  const Facets facets(world_of({wall, wall}), {}, law);
  EXPECT_LT(Bvh(facets).find({1, 0, 0}).facet, 2);
}

TEST(OracleBvh, EmptyWorldIsNeverHit) {
  const Facets facets(world_of({}), {}, law);
  EXPECT_FALSE(Bvh(facets).nearest({1, 0, 0}).is_hit());
}

TEST(OracleShapes, KnownHits) {
  const Material material;
  const render::Pose ahead{{5, 0, 0}, {1, 0, 0, 0}};
  const glm::dvec3 x(1, 0, 0);
  EXPECT_DOUBLE_EQ(make_box(ahead, {2, 2, 2}, material)->nearest(x).range_m, 4);
  EXPECT_DOUBLE_EQ(make_box({}, {2, 4, 6}, material)->nearest(x).range_m, 1);  // from inside
  EXPECT_DOUBLE_EQ(make_sphere({5, 0, 0}, 1, material)->nearest(x).range_m, 4);
  EXPECT_DOUBLE_EQ(make_sphere({0.5, 0, 0}, 1, material)->nearest(x).range_m, 1.5);  // from inside
  EXPECT_DOUBLE_EQ(make_cylinder(ahead, 1, 2, material)->nearest(x).range_m, 4);
  EXPECT_FALSE(make_cylinder(ahead, 1, 2, material)->nearest(glm::normalize(glm::dvec3(1, 0, 0.5))).is_hit());
  // Onto the cap of a cylinder that lies along x: a quarter turn about y.
  const render::Pose lying{{5, 0, 0}, glm::angleAxis(90 * degree, glm::dvec3(0, 1, 0))};
  const SurfaceHit cap = make_cylinder(lying, 1, 2, material)->nearest(x);
  EXPECT_DOUBLE_EQ(cap.range_m, 4);
  EXPECT_NEAR(std::abs(cap.normal.x), 1, 1e-12);
  EXPECT_FALSE(make_thin_wall({5, 3, 0}, {0, 1, 0}, {0, 0, 1}, material)->nearest(x).is_hit());
  EXPECT_DOUBLE_EQ(make_thin_wall({5, 0.5, 0}, {0, 1, 0}, {0, 0, 1}, material)->nearest(x).range_m, 5);
}

TEST(OracleShapes, BoxAndItsMeshAreHitAlike) {
  const render::Pose turned{{6, 0.4, -0.3}, glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, -1)))};
  render::World world = world_of({test::make_block({0, 0, 0}, {2, 1, 1.5}, 0)});
  world.bodies[0].T_world_body = turned;
  const Facets facets(world, {}, law);
  const Bvh bvh(facets);
  const auto box = make_box(turned, {2, 1, 1.5}, {});
  std::mt19937 random(11);
  std::uniform_real_distribution<double> spread(-0.3, 0.3);
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 d = glm::normalize(glm::dvec3(1, spread(random), spread(random)));
    const SurfaceHit a = box->nearest(d);
    const SurfaceHit b = bvh.nearest(d);
    ASSERT_EQ(a.is_hit(), b.is_hit());
    if (a.is_hit()) {
      EXPECT_NEAR(a.range_m, b.range_m, 1e-9);
      EXPECT_NEAR(std::abs(glm::dot(a.normal, b.normal)), 1, 1e-9);
      ++hits;
    }
  }
  EXPECT_GT(hits, 300);
}

}  // namespace

}  // namespace sonard::oracle
