// SPDX-License-Identifier: Apache-2.0
// The survey must never miss a facet that mirrors. The test computes the gain of each facet.
#include "renderer/multipath/mirror_survey.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

constexpr double at_720_khz_m = 1500.0 / 720e3;

World world_of(TriangleMesh mesh, double reflection, double rms_height_m) {
  World world = test::make_world({test::make_body("thing", std::move(mesh))});
  world.bodies[0].parts[0].material.pressure_reflection = reflection;
  world.bodies[0].parts[0].material.rms_height_m = rms_height_m;
  return world;
}

/// The strongest mirror gain of points spread over all facets.
double strongest_gain(const World& world, const glm::dvec3& sonar_m, double range_m) {
  const TriangleMesh& mesh = *world.bodies[0].parts[0].mesh;
  const Mirror mirror(world.bodies[0].parts[0].material);
  double strongest = 0.0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto corner = [&](std::size_t i) {
      return world.bodies[0].T_world_body * glm::dvec3(mesh.positions[mesh.indices[3 * t + i]]);
    };
    const glm::dvec3 n = glm::normalize(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
    for (int i = 0; i <= 4; ++i) {
      for (int j = 0; j <= 4 - i; ++j) {
        const glm::dvec3 at = (static_cast<double>(i) * corner(0) + static_cast<double>(j) * corner(1) +
                               static_cast<double>(4 - i - j) * corner(2)) /
                                  4.0 -
                              sonar_m;
        if (glm::length(at) <= range_m) {
          strongest =
              std::max(strongest, mirror.gain(std::abs(glm::dot(n, at)) / glm::length(at), at_720_khz_m));
        }
      }
    }
  }
  return strongest;
}

TEST(MirrorSurvey, NeverMissesAMirror) {
  int mirrors = 0, spared = 0;
  for (int i = 0; i < 400; ++i) {
    const double rms_height_m = 1e-4 * std::exp2((i % 20) / 2.0);
    World world =
        i % 2 == 0 ? world_of(test::make_quad({-3, -3, 0}, {6, 0, 0}, {0, 6, 0.01F * static_cast<float>(i)}),
                              0.9, rms_height_m)
                   : world_of(test::make_sphere(2, 12), 0.9, rms_height_m);
    world.bodies[0].T_world_body = {{5 + 0.1 * (i % 7), i % 5 - 2.0, i % 3 - 1.0},
                                    glm::angleAxis(0.1 * i, glm::normalize(glm::dvec3(1, i % 4, 2)))};
    const glm::dvec3 sonar_m(0, 0, 0.3 * (i % 9));
    const double range_m = 2 + i % 11;
    const bool found = MirrorSurvey(world).has_mirror(world, sonar_m, range_m, at_720_khz_m);
    const bool is_one = strongest_gain(world, sonar_m, range_m) > least_mirror_gain;
    EXPECT_TRUE(found || !is_one) << i;
    mirrors += is_one ? 1 : 0;
    spared += found ? 0 : 1;
  }
  EXPECT_GT(mirrors, 50);
  EXPECT_GT(spared, 50);
}

TEST(MirrorSurvey, WeakReflectionNeverMirrors) {
  const World world = world_of(test::make_quad({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}), 0.17, 0.0);
  EXPECT_FALSE(MirrorSurvey(world).has_mirror(world, {0, 0, 1e-3}, 100, at_720_khz_m));
  const World stronger = world_of(test::make_quad({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}), 0.18, 0.0);
  EXPECT_TRUE(MirrorSurvey(stronger).has_mirror(stronger, {0, 0, 1e-3}, 100, at_720_khz_m));
}

TEST(MirrorSurvey, WaterMirrorsWhereItIsSeenFlatEnough) {
  // P = 2 k sigma sin gamma = 1.858 makes exp(-P^2) = -15 dB: with 10 mm at sin gamma = 0.0308.
  const Mirror water(-1.0, 0.01);
  EXPECT_TRUE(water_surface_mirrors(water, 1.5, 50, at_720_khz_m));
  EXPECT_FALSE(water_surface_mirrors(water, 1.6, 50, at_720_khz_m));
  EXPECT_FALSE(water_surface_mirrors(water, -1, 50, at_720_khz_m));
  EXPECT_FALSE(water_surface_mirrors(Mirror(-1.0, 0.0), 51, 50, at_720_khz_m));
}

}  // namespace
}  // namespace sonard::render
