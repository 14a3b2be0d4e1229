// SPDX-License-Identifier: Apache-2.0
// The benchmark's worlds match tests/bench/README.md, by hand computation and plain ray casting.
#include "tests/scenes/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/scenes/manifold.hpp"
#include "tests/scenes/shapes.hpp"
#include "tests/support/degree.hpp"

namespace sonard::test {
namespace {

const render::TriangleMesh& mesh_of(const Scene& scene, std::string_view body) {
  return *scene.world.find_body(std::string(body))->parts.at(0).mesh;
}

glm::dvec3 corner(const render::TriangleMesh& mesh, std::size_t triangle, std::size_t k) {
  const glm::vec3& p = mesh.positions[mesh.indices[3 * triangle + k]];
  return {p.x, p.y, p.z};
}

/// Signed volume by the divergence theorem: positive if closed and counter-clockwise from outside.
double volume(const render::TriangleMesh& mesh) {
  double six_fold = 0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    six_fold += glm::dot(corner(mesh, t, 0), glm::cross(corner(mesh, t, 1), corner(mesh, t, 2)));
  }
  return six_fold / 6;
}

/// Whether every edge belongs to two triangles that run along it in opposite directions.
bool closed(const render::TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.indices[i + k], b = mesh.indices[i + (k + 1) % 3];
      edges[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  return std::all_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second == 0; });
}

/// Distance along a unit ray to the nearest triangle of a mesh in world coordinates; infinity if it hits
/// none.
double cast(const render::TriangleMesh& mesh, const glm::dvec3& origin, const glm::dvec3& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const glm::dvec3 a = corner(mesh, t, 0);
    const glm::dvec3 u = corner(mesh, t, 1) - a, v = corner(mesh, t, 2) - a, to_a = origin - a;
    const glm::dvec3 p = glm::cross(direction, v);
    const double determinant = glm::dot(u, p);
    const glm::dvec3 q = glm::cross(to_a, u);
    const double s = glm::dot(to_a, p) / determinant, w = glm::dot(direction, q) / determinant;
    const double range = glm::dot(v, q) / determinant;
    if (determinant != 0 && s >= 0 && w >= 0 && s + w <= 1 && range > 1e-6) {
      nearest = std::min(nearest, range);
    }
  }
  return nearest;
}

struct Place {
  double range_m, azimuth_rad, elevation_rad;
};

Place in_fan(const Scene& scene, const glm::dvec3& p_world) {
  const glm::dvec3 p = render::inverse(scene.T_world_sonar) * p_world;
  return {glm::length(p), std::atan2(p.y, p.x), std::atan2(p.z, std::hypot(p.x, p.y))};
}

bool heard(const Scene& scene, const glm::dvec3& p_world) {
  const Place place = in_fan(scene, p_world);
  const render::Aperture& aperture = scene.settings.aperture;
  return place.range_m < scene.settings.range.max_range_m() &&
         place.azimuth_rad < aperture.beam_edges_rad.front() &&
         place.azimuth_rad > aperture.beam_edges_rad.back() &&
         std::abs(place.elevation_rad) < aperture.elevation_limit_rad();
}

TEST(Bed, HeightsAreThoseOfTheFormula) {
  EXPECT_EQ(flat_height_m(3, 4), 0);
  // 0.3 sin(pi/2) cos(0) at the first crest, 0 on the y axis, the opposite height half a wave to port.
  const double crest_x = std::numbers::pi / 2 / 0.9;
  EXPECT_DOUBLE_EQ(swell_height_m(crest_x, 0), 0.3);
  EXPECT_DOUBLE_EQ(swell_height_m(0, 5), 0);
  EXPECT_NEAR(swell_height_m(crest_x, std::numbers::pi / 0.7), -0.3, 1e-15);
  // The ripple adds 0.05 if sin(7x) = sin(6y) = 1, and 0 if sin(7x) = 0.
  const double x = std::numbers::pi / 14, y = std::numbers::pi / 12;
  EXPECT_NEAR(ripple_height_m(x, y) - 0.3 * std::sin(0.9 * x) * std::cos(0.7 * y), 0.05, 1e-15);
  EXPECT_NEAR(ripple_height_m(std::numbers::pi / 7, y), swell_height_m(std::numbers::pi / 7, y), 1e-15);
}

TEST(Bed, VerticesLieOnTheHeightAndFacetsLookUp) {
  const render::TriangleMesh mesh = make_bed({-1, 3, 2, 4}, 8, 6, ripple_height_m);
  ASSERT_EQ(mesh.positions.size(), 9U * 7U);
  ASSERT_EQ(mesh.triangle_count(), 2U * 8U * 6U);
  EXPECT_TRUE(mesh.normals.empty());
  for (const glm::vec3& p : mesh.positions) {
    EXPECT_NEAR(static_cast<double>(p.z), ripple_height_m(static_cast<double>(p.x), static_cast<double>(p.y)),
                1e-6);
  }
  double area_from_above = 0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const glm::dvec3 a = corner(mesh, t, 0);
    const double twice = glm::cross(corner(mesh, t, 1) - a, corner(mesh, t, 2) - a).z;
    EXPECT_GT(twice, 0);
    area_from_above += twice / 2;
  }
  EXPECT_NEAR(area_from_above, 4 * 2, 1e-5);
}

TEST(Shapes, AreClosedAndTurnedOutward) {
  const render::TriangleMesh block = make_block({1, 2, 3}, {1.6, 1.0, 0.5}, 0.4);
  EXPECT_TRUE(closed(block));
  EXPECT_EQ(block.triangle_count(), 12U);
  EXPECT_NEAR(volume(block), 1.6 * 1.0 * 0.5, 1e-5);

  const render::TriangleMesh ball = make_ball({-1, 0, 2}, 0.6, 64, 32);
  EXPECT_TRUE(closed(ball));
  EXPECT_EQ(ball.triangle_count(), 2U * 64U * 31U);
  EXPECT_NEAR(volume(ball) / (4 * std::numbers::pi / 3 * 0.216), 1, 0.005);  // inscribed: a little less
  EXPECT_LT(volume(ball), 4 * std::numbers::pi / 3 * 0.216);

  for (const glm::dvec3& to : {glm::dvec3(1, 2, 5), glm::dvec3(4, 3, 3)}) {  // upright and slanted
    const glm::dvec3 from(1, 2, 3);
    const render::TriangleMesh tube = make_tube(from, to, 0.25, 48, 7);
    EXPECT_TRUE(closed(tube));
    EXPECT_EQ(tube.triangle_count(), 2U * 48U * 8U);
    // A prism over a regular polygon of 48 sides.
    const double base = 48 / 2.0 * 0.0625 * std::sin(2 * std::numbers::pi / 48);
    EXPECT_NEAR(volume(tube), base * glm::distance(from, to), 1e-5);
  }
}

TEST(Scenes, EveryNameMakesASceneWithThatName) {
  std::set<std::string> names;
  for (const std::string& name : scene_names()) {
    EXPECT_TRUE(names.insert(name).second) << name;
    if (name != "b4_manifold_1e7") {  // takes seconds; its family is tested at other sizes
      EXPECT_EQ(make_scene(name).name, name);
    }
  }
  EXPECT_THROW(make_scene("atlantis"), std::invalid_argument);
}

TEST(Scenes, SizesAreAsPublished) {
  EXPECT_EQ(make_scene("plane").world.triangle_count(), 2U * 223U * 223U);
  for (const char* name : {"flat100k", "swell100k", "ripple100k", "msis_swell", "msis_ripple"}) {
    EXPECT_EQ(make_scene(name).world.triangle_count(), 106'830U) << name;
  }
  EXPECT_NEAR(static_cast<double>(make_scene("swell1m").world.triangle_count()), 1e6, 2e3);
  for (const std::size_t triangles : {5'000U, 10'000U, 100'000U, 1'000'000U}) {
    EXPECT_NEAR(
        static_cast<double>(make_manifold(triangles).triangle_count()) / static_cast<double>(triangles), 1,
        0.05);
  }
  EXPECT_EQ(make_scene("b6_water").world.triangle_count(), 0U);
  EXPECT_EQ(make_scene("b7_pipes").world.bodies.size(), 40U);
}

TEST(Scenes, NoTriangleIsDegenerateAndNoneHasNormals) {
  for (const std::string& name : scene_names()) {
    if (name.starts_with("docking") || name == "b4_manifold_1e7") {
      continue;
    }
    const Scene scene = make_scene(name);
    for (const render::Body& body : scene.world.bodies) {
      const render::TriangleMesh& mesh = *body.parts.at(0).mesh;
      EXPECT_TRUE(mesh.normals.empty());
      EXPECT_EQ(body.parts[0].material.lambert_mu, scene_lambert_mu);
      std::size_t degenerate = 0;
      for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        const glm::dvec3 a = corner(mesh, t, 0);
        degenerate += glm::length(glm::cross(corner(mesh, t, 1) - a, corner(mesh, t, 2) - a)) < 1e-9 ? 1 : 0;
      }
      EXPECT_EQ(degenerate, 0U) << name << " " << body.name;
    }
  }
}

TEST(Scenes, TheSeabedFillsTheFan) {
  // Beyond its lower edge every ray of the fan meets the bed before 20 m or passes 20 m above it. A walk
  // along the four borders of the fan shows both.
  const Scene scene = make_scene("plane");
  const render::TriangleMesh& bed = mesh_of(scene, "bed");
  glm::dvec3 low(1e9), high(-1e9);
  for (const glm::vec3& p : bed.positions) {
    low = glm::min(low, glm::dvec3(p));
    high = glm::max(high, glm::dvec3(p));
  }
  EXPECT_NEAR(high.x - low.x, 40, 1e-4);
  EXPECT_NEAR(high.y - low.y, 40, 1e-4);
  int met = 0;
  for (int i = 0; i <= 48; ++i) {
    for (int j = 0; j <= 20; ++j) {
      const double psi = (-60 + 2.5 * i) * degree, theta = (-10 + j) * degree;
      const glm::dvec3 d =
          scene.T_world_sonar.orientation *
          glm::dvec3(std::cos(theta) * std::cos(psi), std::cos(theta) * std::sin(psi), std::sin(theta));
      const double range_m = d.z < 0 ? scene.T_world_sonar.position_m.z / -d.z : 1e9;
      if (range_m < 20.5) {
        ++met;
        const glm::dvec3 p = scene.T_world_sonar.position_m + range_m * d;
        EXPECT_TRUE(p.x > low.x && p.x < high.x && p.y > low.y && p.y < high.y) << psi << " " << theta;
      }
    }
  }
  EXPECT_GT(met, 300);
}

TEST(Scenes, TheFirstEchoOfThePlaneIsWhereGeometrySaysIt) {
  // The lowest rays of the middle beam look 30 degrees down from 4 m.
  const Scene scene = make_scene("plane");
  const double nearest_m = 4 / std::sin(30 * degree);
  ASSERT_TRUE(scene.plane.has_value());
  EXPECT_EQ(scene.plane->density(0, 1, nearest_m - 1e-6), 0);
  EXPECT_GT(scene.plane->density(0, nearest_m, nearest_m + 1e-3), 0);
}

class SeabedObject : public ::testing::TestWithParam<const char*> {};

TEST_P(SeabedObject, LiesInTheFanOverABearingOfItsOwn) {
  const Scene scene = make_scene("swell100k");
  const render::TriangleMesh& mesh = mesh_of(scene, GetParam());
  double lowest = 1e9, highest = -1e9;
  for (const glm::vec3& p : mesh.positions) {
    const glm::dvec3 p_world(p);
    if (p_world.z > 0.35) {  // above the highest crest
      EXPECT_TRUE(heard(scene, p_world)) << p_world.x << " " << p_world.y << " " << p_world.z;
    }
    lowest = std::min(lowest, in_fan(scene, p_world).azimuth_rad);
    highest = std::max(highest, in_fan(scene, p_world).azimuth_rad);
  }
  for (const char* other : {"box", "sphere", "pipeline", "pole"}) {
    if (std::string(other) != GetParam()) {
      const auto& positions = mesh_of(scene, other).positions;
      EXPECT_TRUE(std::none_of(positions.begin(), positions.end(), [&](const glm::vec3& p) {
        const double azimuth = in_fan(scene, glm::dvec3(p)).azimuth_rad;
        return azimuth > lowest && azimuth < highest;
      })) << other;
    }
  }
}

TEST_P(SeabedObject, IsSeenAndCastsAShadowOnTheBed) {
  const Scene scene = make_scene("swell100k");
  const render::TriangleMesh& object = mesh_of(scene, GetParam());
  const render::TriangleMesh& bed = mesh_of(scene, "bed");
  const glm::dvec3 origin = scene.T_world_sonar.position_m;
  glm::dvec3 centre(0);
  for (const glm::vec3& p : object.positions) {
    centre += glm::dvec3(p) / static_cast<double>(object.positions.size());
  }
  const glm::dvec3 direction = glm::normalize(centre - origin);
  const double object_m = cast(object, origin, direction);
  const double bed_m = cast(bed, origin, direction);
  EXPECT_LT(object_m, 20);
  EXPECT_GT(bed_m, object_m);
  EXPECT_LT(bed_m, 20) << "the shadow is out of range";
  for (const char* other : {"box", "sphere", "pipeline", "pole"}) {
    if (std::string(other) != GetParam()) {
      EXPECT_GT(cast(mesh_of(scene, other), origin, direction), object_m) << other;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Objects, SeabedObject, ::testing::Values("box", "sphere", "pipeline", "pole"),
                         [](const auto& object) { return std::string(object.param); });

TEST(Scenes, TheScanningSonarHearsBedAndPipeline) {
  const Scene scene = make_scene("msis_swell");
  EXPECT_EQ(scene.settings.aperture.beam_count(), 1);
  EXPECT_EQ(scene.settings.range.count, 500);
  const auto& positions = mesh_of(scene, "pipeline").positions;
  // The pipeline crosses the beam: some of it is to port, some to starboard.
  EXPECT_TRUE(std::any_of(positions.begin(), positions.end(), [&](const glm::vec3& p) {
    return in_fan(scene, glm::dvec3(p)).azimuth_rad > 1.5 * degree;
  }));
  EXPECT_TRUE(std::any_of(positions.begin(), positions.end(), [&](const glm::vec3& p) {
    return in_fan(scene, glm::dvec3(p)).azimuth_rad < -1.5 * degree;
  }));
  EXPECT_TRUE(heard(scene, scene.T_world_sonar * glm::dvec3(10, 0, -1)));
}

TEST(Scenes, EveryThinPipeHasItsOwnBeams) {
  const Scene scene = make_scene("b7_pipes");
  double last = -61 * degree;
  for (const render::Body& body : scene.world.bodies) {
    double lowest = 1e9, highest = -1e9;
    for (const glm::vec3& p : body.parts[0].mesh->positions) {
      EXPECT_TRUE(heard(scene, glm::dvec3(p)));
      lowest = std::min(lowest, in_fan(scene, glm::dvec3(p)).azimuth_rad);
      highest = std::max(highest, in_fan(scene, glm::dvec3(p)).azimuth_rad);
    }
    EXPECT_GT(lowest, last) << body.name;  // from starboard to port, without overlap
    last = highest;
  }
}

TEST(Scenes, TheTankSurroundsTheSonar) {
  const Scene scene = make_scene("b5_tank");
  const render::TriangleMesh& tank = mesh_of(scene, "tank");
  for (const glm::dvec3& axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)}) {
    const double ahead = cast(tank, scene.T_world_sonar.position_m, axis);
    const double behind = cast(tank, scene.T_world_sonar.position_m, -axis);
    EXPECT_NEAR(ahead + behind, glm::dot(axis, glm::dvec3(6, 5, 3)), 1e-5);
  }
  EXPECT_LT(glm::length(glm::dvec3(6, 5, 3)), scene.settings.range.max_range_m() + 0.5);
}

TEST(Scenes, TheDockingStationIsAheadOfTheDemosFirstPose) {
  const Scene scene = make_scene("docking");
  ASSERT_NE(scene.world.find_body("docking_station"), nullptr);
  std::size_t in_view = 0;
  for (const render::BodyPart& part : scene.world.find_body("docking_station")->parts) {
    const render::Pose T_world_part =
        scene.world.find_body("docking_station")->T_world_body * part.T_body_part;
    for (const glm::vec3& p : part.mesh->positions) {
      in_view += heard(scene, T_world_part * glm::dvec3(p)) ? 1 : 0;
    }
  }
  EXPECT_GT(in_view, 100U);
}

}  // namespace
}  // namespace sonard::test
