// SPDX-License-Identifier: Apache-2.0
// Public worlds (tests/data/public_worlds) load, and their bodies are at the places in their files. Boxes are
// computed by hand from sizes and poses there and in make_meshes.py.
#include <algorithm>
#include <cstdlib>
#include <map>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/scene/world.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::filesystem::path folder = std::filesystem::path(SONARD_SOURCE_DIR) / "tests/data/public_worlds";

/// The sides of the box around a body in the world, in metres.
test::Bounds box_of(const Body& body) {
  test::Bounds box;
  for (const BodyPart& part : body.parts) {
    for (const glm::vec3& position : part.mesh->positions) {
      const glm::dvec3 in_body =
          part.T_body_part.position_m + part.T_body_part.orientation * glm::dvec3(position);
      const glm::dvec3 p = body.T_world_body.position_m + body.T_world_body.orientation * in_body;
      box.low = glm::min(box.low, p);
      box.high = glm::max(box.high, p);
    }
  }
  return box;
}

/// The model turns the mesh by a <pose>, as Gazebo requires.
const auto tells_of_amphora = HasSubstr("<up_axis> Y_UP is not applied, as in Gazebo, to amphora.dae");

class PublicWorlds : public testing::Test {
 protected:
  PublicWorlds() { setenv("GZ_FUEL_CACHE_PATH", (folder / "fuel").c_str(), 1); }
  ~PublicWorlds() override { unsetenv("GZ_FUEL_CACHE_PATH"); }

  static World load(const char* name, MissingFiles missing = MissingFiles::error) {
    World world = load_world(folder / name, {}, missing);
    const MeshDiagnostics& repaired = world.diagnostics;
    EXPECT_EQ(repaired.degenerate_triangles + repaired.non_finite_triangles + repaired.bad_normals, 0U);
    return world;
  }

  static void expect_box(const World& world, const char* name, const glm::dvec3& low, const glm::dvec3& high,
                         double tolerance_m = 1e-3) {
    SCOPED_TRACE(name);
    const Body* const body = world.find_body(name);
    ASSERT_NE(body, nullptr);
    const test::Bounds box = box_of(*body);
    EXPECT_LT(glm::length(box.low - low), tolerance_m) << box.low.x << " " << box.low.y << " " << box.low.z;
    EXPECT_LT(glm::length(box.high - high), tolerance_m)
        << box.high.x << " " << box.high.y << " " << box.high.z;
  }
};

// The amphora is 1.2 m high with a radius of 0.36 m, in inches with y up in its file.
TEST_F(PublicWorlds, GazeboClassicOfUuvSimulator) {
  const World world = load("uuv_classic.world");
  EXPECT_THAT(world.warnings, ElementsAre(tells_of_amphora));
  EXPECT_EQ(world.bodies.size(), 3U);
  expect_box(world, "amphora_1", {5.64, 0.64, -12}, {6.36, 1.36, -10.8});
}

TEST_F(PublicWorlds, DaveWithFuelIncludesOfWhichOneIsNotThere) {
  EXPECT_THROW(load("dave_ocean.world"), WorldError);
  const World world = load("dave_ocean.world", MissingFiles::skip);
  EXPECT_THAT(world.warnings,
              ElementsAre(HasSubstr("models/Waves' is not in the local cache of Fuel"), tells_of_amphora));
  EXPECT_EQ(world.bodies.size(), 3U);
  expect_box(world, "pillar", {9.65, 2.65, -6}, {10.35, 3.35, -2});
  expect_box(world, "jar", {6.64, -1.86, -5.75}, {7.36, -1.14, -4.55});
}

// Blocks of 2 x 2 x 0.6 m with gaps of 0.02 m, in a dock that is turned by 0.3 rad.
TEST_F(PublicWorlds, VrxWithADockOfBlocksThatHangOnEachOther) {
  const World world = load("vrx_regatta.sdf");
  EXPECT_THAT(world.warnings, IsEmpty());
  EXPECT_EQ(world.bodies.size(), 4U);
  expect_box(world, "red_2", {8.6, -3.4, -1.6}, {9.4, -2.6, 0.6});
  const double c = std::cos(0.3);
  const double s = std::sin(0.3);
  expect_box(world, "dock", {13 - c - 5.04 * s, -s - c, -0.4}, {13 + c + s, s + 5.04 * c, 0.2});
}

TEST_F(PublicWorlds, ArduSubWithAVehicle) {
  const World world = load("ardusub_underwater.world");
  EXPECT_THAT(world.warnings, IsEmpty());
  EXPECT_EQ(world.bodies.size(), 4U);
  expect_box(world, "bluerov2", {-0.23, -0.17, -6.11}, {0.23, 0.17, -5.885}, 0.02);  // its thruster is tilted
  expect_box(world, "ball", {7.5, -0.5, -6.5}, {8.5, 0.5, -5.5});
}

TEST_F(PublicWorlds, SdfOneTen) {
  const World world = load("sdf_1_10.sdf");
  EXPECT_THAT(world.warnings, IsEmpty());
  expect_box(world, "ground_plane", {-20, -20, -4}, {20, 20, -4});
  expect_box(world, "capsule", {6.7, -2.3, -3.9}, {7.3, -1.7, -2.1});
}

TEST_F(PublicWorlds, SdfOneEleven) {
  const World world = load("sdf_1_11.sdf");
  EXPECT_THAT(world.warnings, ElementsAre(tells_of_amphora));
  expect_box(world, "gripper", {4.8, 0.3, -4.15}, {6.2, 0.7, -3.85});
}

TEST_F(PublicWorlds, SdfOneTwelve) {
  const World world = load("sdf_1_12.sdf");
  EXPECT_THAT(world.warnings, ElementsAre(HasSubstr("shapes of geometry <polyline> (1): trough::l::v")));
  expect_box(world, "cone", {5.5, -0.5, -4.9}, {6.5, 0.5, -3.9});
  expect_box(world, "ellipsoid", {7.5, 1.5, -4.4}, {8.5, 4.5, -3.6});  // a quarter turn
}

// The whole pier is turned by 90 degrees: its x axis is along y in the world. The jar is 4 m behind the
// crane, which stands 2 m ahead on a deck 0.5 m up.
TEST_F(PublicWorlds, NestedAndMergedIncludes) {
  const World world = load("nested_includes.sdf");
  EXPECT_THAT(world.warnings, ElementsAre(tells_of_amphora));
  EXPECT_EQ(world.bodies.size(), 2U);
  expect_box(world, "pier", {9, -3, -3 - 1.3}, {11, 3, -3 + 2.6});
}

TEST_F(PublicWorlds, HeightmapWithTexturesThatAreNotThere) {
  const World world = load("heightmap_lake.sdf");
  EXPECT_THAT(world.warnings, IsEmpty());
  const Body* const bed = world.find_body("lake_bed");
  ASSERT_NE(bed, nullptr);
  const test::Bounds box = box_of(*bed);
  EXPECT_LT(glm::length(box.high - glm::dvec3(30, 30, -2)), 1e-6);
  EXPECT_NEAR(box.low.z, -10.0, 0.1);
}

TEST_F(PublicWorlds, LraUvWithADeepTileThatIsNotThere) {
  const World world = load("lrauv_trench.sdf", MissingFiles::skip);
  EXPECT_THAT(world.warnings, ElementsAre(HasSubstr("Portuguese Ledge Tile 2_3' is not in the local cache")));
  EXPECT_EQ(world.bodies.size(), 3U);
  expect_box(world, "mooring", {8.75, -2.25, -30}, {9.25, -1.75, -24});
}

/// Worlds whose models are found through environment variables, as their readme files require.
class FoundByTheEnvironment : public PublicWorlds {
 protected:
  FoundByTheEnvironment() {
    setenv("GZ_SIM_RESOURCE_PATH", (folder / "shelf").c_str(), 1);
    setenv("GAZEBO_RESOURCE_PATH", (folder / "resources").c_str(), 1);
  }
  ~FoundByTheEnvironment() override {
    unsetenv("GZ_SIM_RESOURCE_PATH");
    unsetenv("GAZEBO_RESOURCE_PATH");
  }

  static World load(const char* name, MissingFiles missing = MissingFiles::error) {
    return load_world(folder / name, model_folders_from_environment(), missing);
  }
};

// The bed is 4 m high from -10, in a model at -1. The hull is 0.6 m along the vehicle's x, which is the
// world's y.
TEST_F(FoundByTheEnvironment, BlueRov2OverABedWithANormalMap) {
  const World world = load("bluerov2_lake.world");
  EXPECT_THAT(world.warnings, IsEmpty());
  const Body* const bed = world.find_body("sand_bed");
  ASSERT_NE(bed, nullptr);
  EXPECT_LT(glm::length(box_of(*bed).high - glm::dvec3(40, 40, -7)), 1e-6);
  EXPECT_NEAR(box_of(*bed).low.z, -11.0, 0.05);
  EXPECT_NE(bed->parts.at(0).normal_map, nullptr);
  expect_box(world, "bluerov2", {4.8, -3.3, -4.1}, {5.2, -2.7, -3.8});
}

// The course is turned by 90 degrees about (20, 10): (x, y) in it is (20 - y, 10 + x) in the world. Decks are
// 2 x 4 m; platform_b is 2 m beyond the edge of platform_a, which is 2 m from its middle; the merged one is
// at (-6, 0).
TEST_F(FoundByTheEnvironment, VrxCourseOfPlatformsInAModel) {
  EXPECT_THROW(load("sydney_regatta_course.sdf"), WorldError);
  const World world = load("sydney_regatta_course.sdf", MissingFiles::skip);
  EXPECT_THAT(world.warnings,
              ElementsAre(HasSubstr("mb_marker_buoy_white' is not in the local cache of Fuel")));
  EXPECT_EQ(world.bodies.size(), 2U);
  ASSERT_NE(world.find_body("Coast Waves"), nullptr);
  EXPECT_TRUE(world.find_body("Coast Waves")->parts.empty());
  EXPECT_EQ(world.find_body("course")->parts.size(), 3U);
  expect_box(world, "course", {14, 3, 0}, {22, 15, 0.5});
}

// In the glider: the hull is 2 m long and 0.2 m thick, the fin 0.1 to 0.5 m above its end, a box 0.5 m ahead
// of the middle, and a lamp 0.2 m to port of that. It heads west.
TEST_F(FoundByTheEnvironment, DaveGliderOfFlattenedNames) {
  const World world = load("dave_glider.world");
  EXPECT_THAT(world.warnings, IsEmpty());
  EXPECT_EQ(world.bodies.size(), 1U);
  expect_box(world, "glider", {9, -0.25, -20.1}, {11.1, 0.1, -19.5});
  const Body& glider = *world.find_body("glider");
  std::vector<glm::dvec3> places;
  for (const BodyPart& part : glider.parts) {
    places.push_back(part.T_body_part.position_m);
  }
  for (const glm::dvec3& expected :
       {glm::dvec3(0, 0, 0), glm::dvec3(-1, 0, 0.3), glm::dvec3(0.5, 0, 0.2), glm::dvec3(0.5, 0.2, 0.2)}) {
    EXPECT_TRUE(std::any_of(places.begin(), places.end(),
                            [&](const glm::dvec3& place) { return glm::length(place - expected) < 1e-9; }))
        << expected.x << " " << expected.y << " " << expected.z;
  }
}

// The quay is 20 m along y and, scaled by 2, 10 m high. The state has moved the anchor, turned it by 90
// degrees, and made it 2 m long and half a metre wide.
TEST_F(FoundByTheEnvironment, UuvLakeThatGazeboSaved) {
  const World world = load("uuv_lake.world");
  EXPECT_THAT(world.warnings, IsEmpty());
  EXPECT_LT(glm::length(box_of(*world.find_body("lake_bed")).high - glm::dvec3(30, 30, 0)), 1e-6);
  expect_box(world, "quay", {25, -10, -5}, {25, 10, 5});
  expect_box(world, "anchor", {11.75, -5, -8}, {12.25, -3, -7});
}

TEST_F(FoundByTheEnvironment, Orca4OverSandWithANormalMap) {
  const World world = load("orca4_sand.sdf");
  EXPECT_THAT(world.warnings, IsEmpty());
  expect_box(world, "sand", {-200, -200, -9.5}, {200, 200, -9});
  for (const BodyPart& part : world.find_body("sand")->parts) {
    EXPECT_NE(part.normal_map, nullptr);
  }
  expect_box(world, "rov", {-3.3, -0.2, -0.3}, {-2.7, 0.2, 0});
}

TEST_F(PublicWorlds, WreckAsGlb) {
  const World world = load("glb_wreck.sdf");
  EXPECT_THAT(world.warnings, ElementsAre(tells_of_amphora));
  // Its length lies along 60 degrees; its bow and stern are points.
  const Body* const wreck = world.find_body("wreck");
  ASSERT_NE(wreck, nullptr);
  const test::Bounds box = box_of(*wreck);
  EXPECT_NEAR(box.high.y, 6 * std::sin(std::acos(-1.0) / 3), 0.1);
  EXPECT_NEAR(box.low.z, -20.0, 1e-6);
  EXPECT_NEAR(box.high.z, -18.0, 1e-6);
  EXPECT_EQ(wreck->parts[0].material.name, "steel_fouled");
}

}  // namespace
}  // namespace sonard::render
