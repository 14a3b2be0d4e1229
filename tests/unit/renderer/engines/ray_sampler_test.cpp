// SPDX-License-Identifier: Apache-2.0
// Samples of RaySampler against the closed form of a plane, sample by sample; independence of packets and
// threads; surfaces that are hard to hit.
#include "renderer/engines/cpu/ray_sampler.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using test::make_body;
using test::make_quad;
using test::make_sphere;
using test::make_world;

constexpr double far_m = 1000;

/// A world and its sampler.
class Traced {
 public:
  Traced(World world, WorkerPool& workers, const std::string& embree_settings = {})
      : index_(std::move(world), workers, embree_settings), sampler_(index_, workers) {}

  auto sample(const Pose& T_world_sonar, const SampleGrid& grid, const SurfaceModel& surface,
              double max_range_m) {
    return sampler_.sample(T_world_sonar, grid, surface, max_range_m);
  }
  void set_body_pose(std::size_t body, const Pose& pose) { index_.set_body_pose(body, pose); }
  const std::string& description() const { return index_.description(); }

 private:
  SpatialIndex index_;
  RaySampler sampler_;
};

SampleGrid make_grid(int columns, int rows) {
  Aperture aperture;
  aperture.beam_edges_rad = equal_angle_edges(8, 120 * degree);
  return make_sample_grid(aperture, Sampling::of_grid(3, columns, rows));
}

/// Calls use(view, x, y, sample) for every pixel the grid uses; x and y are the tangents of its centre.
template <class Use>
void for_each_sample(const SampleGrid& grid, const std::vector<const SurfaceSample*>& samples, Use use) {
  for (const ColumnPart& part : grid.parts) {
    const auto v = static_cast<std::size_t>(part.view);
    const SubView& view = grid.views[v];
    for (int row = part.row_begin; row < part.row_end; ++row) {
      use(view, -view.tan_half_width + (part.column + 0.5) * view.pixel_width(),
          -view.tan_half_height + (row + 0.5) * view.pixel_height(),
          samples[v][static_cast<std::ptrdiff_t>(row) * view.columns + part.column]);
    }
  }
}

/// The ray of a pixel in the sonar frame.
glm::dvec3 ray(const SubView& view, double x, double y) {
  const double c = std::cos(view.azimuth_rad);
  const double s = std::sin(view.azimuth_rad);
  return {c + x * s, s - x * c, y};
}

std::size_t count_seen(const SampleGrid& grid, const std::vector<const SurfaceSample*>& samples) {
  std::size_t seen = 0;
  for_each_sample(grid, samples, [&](const SubView&, double, double, const SurfaceSample& sample) {
    seen += sample.range_m > 0 ? 1 : 0;
  });
  return seen;
}

/// A wavy bed with vertex normals, a ball and a box over it.
World busy_world() {
  TriangleMesh bed;
  constexpr std::uint32_t cells = 80;
  for (std::uint32_t j = 0; j <= cells; ++j) {
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const float x = -20.0F + 0.5F * static_cast<float>(i);
      const float y = -20.0F + 0.5F * static_cast<float>(j);
      bed.positions.emplace_back(x, y, 0.3F * std::sin(x) * std::cos(0.8F * y));
    }
  }
  for (std::uint32_t j = 0; j < cells; ++j) {
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t a = j * (cells + 1) + i;
      bed.indices.insert(bed.indices.end(), {a, a + 1, a + cells + 2, a, a + cells + 2, a + cells + 1});
    }
  }
  World world = make_world({make_body("bed", bed, 0.01), make_body("ball", make_sphere(0.7F, 24), 0.1),
                            make_body("box", make_quad({0, 0, 0}, {0, 1, 0}, {0, 0, 2}), 0.05)});
  world.bodies[1].T_world_body.position_m = {5, 1, 0.5};
  world.bodies[2].T_world_body.position_m = {7, -2, 0};
  return world;
}

Pose over_the_bed() {
  return {{0, 0, 3}, glm::angleAxis(20 * degree, glm::dvec3(0, 1, 0))};
}

// Equation 2 of docs/physics.md 2.3, in double precision. Some sizes are no multiples of a packet's sides.
TEST(RaySampler, SamplesOfAPlaneFollowTheClosedForm) {
  const glm::dvec3 n =
      glm::normalize(glm::dvec3(0.8, 0.35, -0.5));  // in the world, pointing away from the sonar
  const glm::dvec3 a = glm::normalize(glm::cross(n, glm::dvec3(0, 0, 1)));
  const glm::dvec3 b = glm::cross(n, a);
  const glm::dvec3 foot = glm::dvec3(9, 0, 0);
  constexpr double mu = 0.02;
  const glm::dvec3 corner = foot - 100.0 * a - 100.0 * b;
  const World world = make_world({make_body("slope", make_quad(corner, 200.0 * a, 200.0 * b), mu)});
  const Pose T_world_sonar{{0.5, -1, 0.3}, glm::angleAxis(0.4, glm::normalize(glm::dvec3(1, 2, 3)))};
  const glm::dvec3 n_sonar = glm::conjugate(T_world_sonar.orientation) * n;
  const double distance_m = glm::dot(n, foot - T_world_sonar.position_m);
  WorkerPool workers(2);
  Traced sampler(world, workers);
  for (const auto& [columns, rows] :
       {std::pair{64, 64}, std::pair{37, 29}, std::pair{3, 2}, std::pair{41, 130}}) {
    const SampleGrid grid = make_grid(columns, rows);
    std::size_t seen = 0;
    for_each_sample(grid, sampler.sample(T_world_sonar, grid, {}, 50),
                    [&](const SubView& view, double x, double y, const SurfaceSample& sample) {
                      const glm::dvec3 q = ray(view, x, y);
                      const double nq = glm::dot(n_sonar, q);
                      const double range_m = distance_m * glm::length(q) / nq;
                      if (nq <= 0 || range_m > 50) {
                        return;
                      }
                      ++seen;
                      const glm::dvec3 q_x(std::sin(view.azimuth_rad), -std::cos(view.azimuth_rad), 0);
                      const double qq = glm::dot(q, q);
                      const double dx = range_m * (glm::dot(q, q_x) / qq - glm::dot(n_sonar, q_x) / nq);
                      const double dy = range_m * (y / qq - n_sonar.z / nq);
                      ASSERT_NEAR(sample.range_m, range_m, 2e-6 * range_m * range_m / distance_m);
                      ASSERT_NEAR(sample.response, mu * distance_m / range_m, 1e-6);
                      ASSERT_NEAR(sample.range_dx, dx, 1e-5 * range_m * range_m / distance_m);
                      ASSERT_NEAR(sample.range_dy, dy, 1e-5 * range_m * range_m / distance_m);
                    });
    EXPECT_GT(seen, grid.cell_count() / 3) << columns << " x " << rows;
  }
}

TEST(RaySampler, PacketsOfEveryWidthSeeTheSame) {
  const World world = busy_world();
  const SampleGrid grid = make_grid(128, 128);
  WorkerPool workers(2);
  Traced widest(world, workers);
  const auto expected = widest.sample(over_the_bed(), grid, {}, far_m);
  ASSERT_GT(count_seen(grid, expected), grid.cell_count() / 2);
  std::vector<std::pair<const char*, const char*>> sets{{"isa=sse4.2", "4"}};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    sets.emplace_back("isa=avx2", "8");
  }
#endif
  for (const auto& [settings, width] : sets) {
    Traced sampler(world, workers, settings);
    EXPECT_NE(sampler.description().find(std::string("packets of ") + width), std::string::npos)
        << sampler.description();
    const auto samples = sampler.sample(over_the_bed(), grid, {}, far_m);
    std::size_t different = 0;  // rays on an edge may see either side
    for (std::size_t v = 0; v < grid.views.size(); ++v) {
      for (int i = 0; i < grid.views[v].columns * grid.views[v].rows; ++i) {
        const SurfaceSample& a = expected[v][i];
        const SurfaceSample& b = samples[v][i];
        const bool same = std::abs(a.range_m - b.range_m) <= 1e-4F * a.range_m &&
                          std::abs(a.response - b.response) <= 1e-4F * a.response + 1e-7F;
        different += same ? 0 : 1;
      }
    }
    EXPECT_LT(different, 10U) << settings;
  }
}

TEST(RaySampler, AnyNumberOfThreadsGivesTheSameSamples) {
  const World world = busy_world();
  const SampleGrid grid = make_grid(100, 150);
  WorkerPool one(1);
  Traced alone(world, one);
  const auto expected = alone.sample(over_the_bed(), grid, {}, far_m);
  for (const unsigned threads : {2U, 5U}) {
    WorkerPool workers(threads);
    Traced sampler(world, workers);
    for (int repetition = 0; repetition < 5; ++repetition) {
      const auto samples = sampler.sample(over_the_bed(), grid, {}, far_m);
      for (std::size_t v = 0; v < grid.views.size(); ++v) {
        ASSERT_TRUE(std::equal(samples[v], samples[v] + std::ptrdiff_t{100} * 150, expected[v])) << threads;
      }
    }
  }
}

// Inside a ball every ray hits: no holes between triangles.
TEST(RaySampler, ClosedSurfacesHaveNoHoles) {
  WorkerPool workers(2);
  Traced sampler(make_world({make_body("ball", make_sphere(5.0F, 100))}), workers);
  const SampleGrid grid = make_grid(256, 512);
  for (int i = 0; i < 4; ++i) {
    const Pose inside{{0.1 * i, 0.3, -0.2 * i}, glm::angleAxis(0.6 * i, glm::normalize(glm::dvec3(1, i, 2)))};
    EXPECT_EQ(count_seen(grid, sampler.sample(inside, grid, {}, far_m)), grid.cell_count());
  }
}

TEST(RaySampler, TilesOutsideTheFanAreNotTraced) {
  WorkerPool workers(2);
  Traced sampler(make_world({make_body("ball", make_sphere(5.0F, 32))}), workers);
  const SampleGrid grid = make_grid(64, 256);
  const auto samples = sampler.sample({}, grid, {}, far_m);
  std::size_t untouched = 0;
  for (std::size_t v = 0; v < grid.views.size(); ++v) {
    // The fan is lowest in mid-view: its first rows there are outside.
    const SurfaceSample& below = samples[v][grid.views[v].columns / 2];
    untouched += below.range_m == 0 && below.response == 0 ? 1 : 0;
  }
  EXPECT_EQ(untouched, grid.views.size());
  EXPECT_EQ(count_seen(grid, samples), grid.cell_count());
}

TEST(RaySampler, SurfacesNearerThanTheNearestDepthAreNotSeen) {
  WorkerPool workers(1);
  Traced sampler(make_world({make_body("near", make_quad({0.015F, -1, -1}, {0, 2, 0}, {0, 0, 2})),
                             make_body("far", make_quad({4, -40, -40}, {0, 80, 0}, {0, 0, 80}))}),
                 workers);
  Aperture narrow;
  narrow.beam_edges_rad = equal_angle_edges(1, 10 * degree);
  const SampleGrid grid = make_sample_grid(narrow, Sampling::of_grid(1, 16, 16));
  for_each_sample(grid, sampler.sample({}, grid, {}, far_m),
                  [](const SubView&, double, double, const SurfaceSample& s) { ASSERT_GT(s.range_m, 3.9F); });
  sampler.set_body_pose(0, {{0.01, 0, 0}, {1, 0, 0, 0}});
  for_each_sample(
      grid, sampler.sample({}, grid, {}, far_m),
      [](const SubView&, double, double, const SurfaceSample& s) { ASSERT_LT(s.range_m, 0.03F); });
}

TEST(RaySampler, OneMeshCanBeInManyPlacesAndMove) {
  World world = make_world({make_body("a", make_quad({0, -40, -40}, {0, 80, 0}, {0, 0, 80}))});
  world.bodies.push_back(world.bodies[0]);
  world.bodies[1].name = "b";
  world.bodies[0].T_world_body.position_m.x = 20;
  world.bodies[1].T_world_body.position_m.x = 10;
  WorkerPool workers(2);
  Traced sampler(world, workers);
  const SampleGrid grid = make_grid(32, 32);
  const auto nearest = [&] {
    float range_m = std::numeric_limits<float>::infinity();
    for_each_sample(grid, sampler.sample({}, grid, {}, far_m),
                    [&](const SubView&, double, double, const SurfaceSample& s) {
                      range_m = std::min(range_m, s.range_m);
                    });
    return range_m;
  };
  EXPECT_NEAR(nearest(), 10, 0.05);
  sampler.set_body_pose(1, {{30, 0, 0}, {1, 0, 0, 0}});
  EXPECT_NEAR(nearest(), 20, 0.05);
  sampler.set_body_pose(0, {{5, 0, 0}, {1, 0, 0, 0}});
  EXPECT_NEAR(nearest(), 5, 0.05);
}

TEST(RaySampler, BackFacesLetRaysPassWhenAskedTo) {
  // The front of `hidden` faces the sonar; `facing_away` stands before it and shows its back.
  const World world = make_world({make_body("facing_away", make_quad({5, -20, -20}, {0, 40, 0}, {0, 0, 40})),
                                  make_body("hidden", make_quad({8, 20, -20}, {0, -40, 0}, {0, 0, 40}))});
  WorkerPool workers(1);
  Traced sampler(world, workers);
  Aperture narrow;
  narrow.beam_edges_rad = equal_angle_edges(1, 10 * degree);
  const SampleGrid grid = make_sample_grid(narrow, Sampling::of_grid(1, 16, 16));
  SurfaceModel model;
  for (const auto& [two_sided, distance_m] :
       {std::pair{true, 5.0}, std::pair{false, 8.0}, std::pair{true, 5.0}}) {
    model.two_sided = two_sided;
    for_each_sample(grid, sampler.sample({}, grid, model, far_m),
                    [distance = distance_m](const SubView&, double, double, const SurfaceSample& s) {
                      ASSERT_NEAR(s.range_m, distance, 0.2);
                    });
  }
}

// S4: the triangle's own normal replaces an invalid vertex normal.
TEST(RaySampler, UselessVertexNormalsAreReplacedByTheTriangles) {
  const TriangleMesh flat = make_quad({5, -20, -20}, {0, 40, 0}, {0, 0, 40});
  WorkerPool workers(1);
  const SampleGrid grid = make_grid(32, 32);
  Traced plain(make_world({make_body("wall", flat)}), workers);
  const auto expected = plain.sample({}, grid, {}, far_m);
  for (const float component : {0.0F, std::numeric_limits<float>::quiet_NaN()}) {
    TriangleMesh mesh = flat;
    mesh.normals.assign(4, glm::vec3(component));
    Traced sampler(make_world({make_body("wall", mesh)}), workers);
    const auto samples = sampler.sample({}, grid, {}, far_m);
    for (std::size_t v = 0; v < grid.views.size(); ++v) {
      EXPECT_TRUE(std::equal(samples[v], samples[v] + std::ptrdiff_t{32} * 32, expected[v])) << component;
    }
  }
}

TEST(RaySampler, AnEmptyWorldEchoesNothing) {
  WorkerPool workers(2);
  Traced sampler(World{}, workers);
  const SampleGrid grid = make_grid(32, 32);
  EXPECT_EQ(count_seen(grid, sampler.sample({}, grid, {}, far_m)), 0U);
}

}  // namespace
}  // namespace sonard::render
