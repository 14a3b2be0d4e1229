// SPDX-License-Identifier: Apache-2.0
// Reasons for a black picture, in a world of one cube, with distances calculated by hand.
#include "server/diagnosis/sight.hpp"

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

/// A closed cube with edges of 2 m.
std::shared_ptr<const render::TriangleMesh> cube() {
  auto mesh = std::make_shared<render::TriangleMesh>();
  for (int i = 0; i < 8; ++i) {
    mesh->positions.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  }
  mesh->indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                   2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return mesh;
}

/// A world with the cube's middle at (10, 0, -20), under a water surface at z = 0.
render::World pier() {
  render::World world;
  world.bodies = {{"pier", {{10, 0, -20}, {1, 0, 0, 0}}, {{cube(), {}, {}, nullptr}}}};
  world.water_surface_z_m = 0.0;
  return world;
}

Sight at(const glm::dvec3& position_m, const glm::dquat& orientation = {1, 0, 0, 0}) {
  Sight sight;
  sight.T_world_vehicle = sight.T_world_sonar = {position_m, orientation};
  sight.range_m = 5.0;
  return sight;
}

std::vector<Finding> look(const render::World& world, const std::vector<PosedBody>& moved,
                          const Sight& sight) {
  return look_around(world, boxes_of(world), moved, sight);
}

std::vector<Finding> only(const std::string& code, const std::string& text) {
  return {{code, text}};
}

TEST(LookAround, FindsNothingWrongWhereASurfaceIsSeen) {
  Sight sight = at({7, 0, -20});
  sight.sees_surface = true;
  EXPECT_TRUE(look(pier(), {}, sight).empty());
}

TEST(LookAround, NamesTheNearestBodyAndItsDistance) {
  // Distance from (2, 0, -20) to the face at x = 9.
  EXPECT_EQ(look(pier(), {}, at({2, 0, -20})),
            only("nothing_near", "Nothing is within 5 m; the nearest body, 'pier', is 7 m away."));
}

TEST(LookAround, TakesBodiesWhereTheyAreNow) {
  // The face is at x = 99.
  EXPECT_EQ(look(pier(), {{"pier", {{100, 0, -20}, {1, 0, 0, 0}}}}, at({2, 0, -20})),
            only("nothing_near", "Nothing is within 5 m; the nearest body, 'pier', is 97 m away."));
}

TEST(LookAround, SaysWhichWayTheNearestBodyIs) {
  // The face at x = 9 is 3 m away. The sonar looks to +y, so the face is to starboard.
  const double half = std::numbers::pi / 4;
  EXPECT_EQ(
      look(pier(), {}, at({6, 0, -20}, {std::cos(half), 0, 0, std::sin(half)})),
      only("nothing_in_fan",
           "Nothing is in the fan; the nearest body, 'pier', is 3 m away, 90 degrees to starboard and 0 "
           "degrees above the axis of the sonar."));
}

TEST(LookAround, SuspectsThatZIsDown) {
  EXPECT_EQ(look(pier(), {}, at({7, 0, 20})),
            only("above_surface", "The sonar is 20.0 m above the water surface, in the air (is z down?)."));
  render::World no_surface = pier();
  no_surface.water_surface_z_m.reset();
  const auto found = look(no_surface, {}, at({7, 0, 20}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].code, "z_down");
}

TEST(LookAround, SuspectsMillimetresAndCentimetres) {
  auto found = look(pier(), {}, at({7000, 0, -20000}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].code, "wrong_unit");
  EXPECT_NE(found[0].text.find("are positions in millimetres?"), std::string::npos);
  found = look(pier(), {}, at({700, 0, -2000}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NE(found[0].text.find("are positions in centimetres?"), std::string::npos);
}

TEST(LookAround, SuspectsAQuaternionWithWFirst) {
  // The unit quaternion, sent as w, x, y, z = (1, 0, 0, 0) and read as x, y, z, w, is half a turn about x.
  Sight sight = at({7, 0, -20}, {0, 1, 0, 0});
  sight.sees_surface = true;
  const auto found = look(pier(), {}, sight);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].code, "quaternion_w_first");
}

TEST(LookAround, SuspectsItAtOtherHeadingsToo) {
  // 120 degrees about z, sent as w, x, y, z = (1/2, 0, 0, sqrt(3)/2) and read as x, y, z, w.
  Sight sight = at({7, 0, -20}, {std::sqrt(3.0) / 2, 0.5, 0, 0});
  sight.sees_surface = true;
  ASSERT_EQ(look(pier(), {}, sight).size(), 1U);
  EXPECT_EQ(look(pier(), {}, sight)[0].code, "quaternion_w_first");
}

TEST(LookAround, TakesAVehicleThatLeansForOne) {
  // Rolled by 60 degrees, then pitched by 20: no order of the numbers makes this level.
  const glm::dquat roll(std::cos(std::numbers::pi / 6), std::sin(std::numbers::pi / 6), 0, 0);
  const glm::dquat pitch(std::cos(std::numbers::pi / 18), 0, std::sin(std::numbers::pi / 18), 0);
  Sight sight = at({7, 0, -20}, pitch * roll);
  sight.sees_surface = true;
  EXPECT_TRUE(look(pier(), {}, sight).empty());
}

TEST(LookAround, SaysThatTheSonarIsInsideOfABody) {
  Sight sight = at({10.2, 0.1, -20.3});
  sight.sees_surface = true;  // the inner side of the cube
  EXPECT_EQ(look(pier(), {}, sight), only("inside_body", "The sonar is inside the body 'pier'."));
  sight.vehicle_model = "pier";
  EXPECT_EQ(look(pier(), {}, sight)[0].text,
            "The sonar is inside the body 'pier', its own vehicle (to hide it, set hides_vehicle: true).");
  sight.hides_vehicle = true;
  EXPECT_TRUE(look(pier(), {}, sight).empty());
}

TEST(LookAround, FindsNothingWrongWithOpenWater) {
  EXPECT_TRUE(look({}, {}, at({0, 0, 0})).empty());
}

TEST(LookAround, SaysThatTheOnlyBodyIsHidden) {
  Sight sight = at({2, 0, -20});
  sight.vehicle_model = "pier";
  sight.hides_vehicle = true;
  EXPECT_EQ(look(pier(), {}, sight),
            only("empty_world",
                 "The world has no body that reflects sound, because the vehicle's own model is hidden."));
}

/// A box with these edges and its middle at the origin. Its faces point outwards or inwards.
std::shared_ptr<const render::TriangleMesh> box(const glm::vec3& size, bool inwards = false) {
  auto mesh = std::make_shared<render::TriangleMesh>(*cube());
  for (glm::vec3& position : mesh->positions) {
    position *= 0.5F * size;
  }
  for (std::size_t i = 0; inwards && i < mesh->indices.size(); i += 3) {
    std::swap(mesh->indices[i], mesh->indices[i + 1]);
  }
  return mesh;
}

render::World one(const std::string& name, std::shared_ptr<const render::TriangleMesh> mesh) {
  render::World world;
  world.bodies = {{name, {{0, 0, -20}, {1, 0, 0, 0}}, {{std::move(mesh), {}, {}, nullptr}}}};
  return world;
}

Sight seeing(const glm::dvec3& position_m) {
  Sight sight = at(position_m);
  sight.sees_surface = true;
  return sight;
}

TEST(LookAround, ASolidWallIsNamedHoweverLargeItIs) {
  for (const glm::vec3& size : {glm::vec3(6, 40, 40), glm::vec3(30, 1, 8), glm::vec3(200, 200, 30)}) {
    EXPECT_EQ(look(one("wall", box(size)), {}, seeing({0.1, 0.2, -20.3})),
              only("inside_body", "The sonar is inside the body 'wall'."));
  }
}

TEST(LookAround, ATankWhoseFacesLookInwardsIsNot) {
  const render::World tank = one("tank", box({10, 10, 6}, /*inwards=*/true));
  EXPECT_TRUE(look(tank, {}, seeing({0.1, 0.2, -20.3})).empty());
  EXPECT_EQ(look(tank, {}, at({0.1, 0.2, -20.3}))[0].code, "inside_body") << "where nothing is seen of it";
}

/// A horizontal sheet of 100 m whose front is its upper side.
std::shared_ptr<const render::TriangleMesh> sheet() {
  auto mesh = std::make_shared<render::TriangleMesh>();
  mesh->positions = {{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}};
  mesh->indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

TEST(LookAround, SaysThatTheSonarIsUnderTheBed) {
  const auto expected = only("under_ground",
                             "The sonar is 3.5 m below the body 'bed', and nothing is below the sonar: is it "
                             "under the bed (is z of the pose correct)?");
  EXPECT_EQ(look(one("bed", sheet()), {}, at({7, 3, -23.5})), expected);
  EXPECT_EQ(look(one("bed", sheet()), {}, seeing({7, 3, -23.5})), expected) << "it sees the back of it";
  // A slab 1 m thick, with its lower side at z = -20.5.
  EXPECT_EQ(look(one("bed", box({100, 100, 1})), {}, at({7, 3, -24})), expected);
  Sight faint = seeing({7, 3, -24});
  faint.echo_over_floor = 0.01;
  EXPECT_EQ(look(one("bed", box({100, 100, 1})), {}, faint), expected)
      << "it sees the underside, and no echo stands out";
}

TEST(LookAround, BelowAShipOrIceOrABridgeAllIsWell) {
  EXPECT_TRUE(look(one("ice", box({100, 100, 1})), {}, seeing({7, 3, -24})).empty())
      << "it sees the underside";
  render::World bridge = one("bridge", sheet());
  bridge.bodies.push_back({"bed", {{0, 0, -30}, {1, 0, 0, 0}}, {{sheet(), {}, {}, nullptr}}});
  EXPECT_TRUE(look(bridge, {}, seeing({7, 3, -25})).empty());
  EXPECT_NE(look(bridge, {}, at({7, 3, -25}))[0].code, "under_ground");
  EXPECT_TRUE(look(one("bed", sheet()), {}, seeing({7, 3, -15})).empty()) << "above it";
}

TEST(LookAround, SaysThatNoEchoStandsOut) {
  // The sonar is 3 m above the bed and looks up by 30 degrees. The echo is a hundredth of the noise.
  const double quarter = std::numbers::pi / 12;
  Sight sight = at({0, 0, -17}, {std::cos(quarter), 0, -std::sin(quarter), 0});
  sight.sees_surface = true;
  sight.echo_over_floor = 0.01;
  const auto found = look(one("bed", sheet()), {}, sight);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].code, "too_faint");
  for (const char* part :
       {"No echo stands out: the strongest one is 20 dB below the noise and the smallest step of the "
        "samples. The nearest body, 'bed', is 3 m away, 180 degrees to ",
        " and 60 degrees below the axis of the sonar. Turn the sonar towards it, or move closer."}) {
    EXPECT_NE(found[0].text.find(part), std::string::npos) << found[0].text;
  }
  // A bed as a Gemini 0.2 m above it sees it: its picture is pure noise.
  sight.echo_over_floor = 0.6;
  ASSERT_EQ(look(one("bed", sheet()), {}, sight).size(), 1U);
  EXPECT_NE(look(one("bed", sheet()), {}, sight)[0].text.find("is 2 dB below"), std::string::npos);
  sight.echo_over_floor = 1.5;
  EXPECT_TRUE(look(one("bed", sheet()), {}, sight).empty());
}

TEST(LookAround, SuspectsUtmCoordinatesInALocalWorld) {
  // Trondheim in UTM zone 32: 569 km east, 7034 km north.
  for (const glm::dvec3& p : {glm::dvec3(569000, 7034000, -20), glm::dvec3(7034000, 569000, -20)}) {
    const auto found = look(one("bed", sheet()), {}, at(p));
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].code, "geographic_coordinates");
    EXPECT_NE(found[0].text.find("The position looks like UTM (easting, northing), but the world does not"),
              std::string::npos)
        << found[0].text;
  }
}

TEST(LookAround, SuspectsUtmCoordinatesAboveTheSurface) {
  render::World world = one("bed", sheet());
  world.water_surface_z_m = 0.0;
  const auto found = look(world, {}, at({569000, 7034000, 0.3}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(
      found[0].text,
      "The sonar is 0.3 m above the water surface, in the air. The position looks like UTM (easting, "
      "northing), but the world does not: subtract the position of the world's origin from the poses, or "
      "use the same coordinates for both.");
}

TEST(LookAround, SuspectsEarthCentredCoordinates) {
  // Trondheim: 63.43 degrees north, 10.40 degrees east.
  const auto found = look(one("bed", sheet()), {}, at({2813500, 516400, 5681300}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].code, "geographic_coordinates");
  EXPECT_NE(found[0].text.find("looks like ECEF"), std::string::npos) << found[0].text;
}

TEST(LookAround, SuspectsAFrameWithZDown) {
  Sight sight = at({7, 3, -15});
  // Rolled by 180 degrees, heading north: with w first, this is no level vehicle.
  sight.T_world_vehicle.orientation = glm::angleAxis(std::numbers::pi / 2, glm::dvec3(0, 0, 1)) *
                                      glm::angleAxis(std::numbers::pi, glm::dvec3(1, 0, 0));
  const auto found = look(one("bed", sheet()), {}, sight);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].text,
            "The vehicle is upside down (is z of its frame down? x must be forward, y left and z up).");
}

TEST(LookAround, SuspectsALocalPoseInAWorldOfUtmCoordinates) {
  render::World world = one("bed", sheet());
  world.bodies[0].T_world_body.position_m = {569000, 7034000, -20};
  const auto found = look(world, {}, at({7, 3, -15}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NE(found[0].text.find("The world looks like UTM (easting, northing), but the position does not"),
            std::string::npos)
      << found[0].text;
  EXPECT_EQ(look(world, {}, at({569300, 7034000, -15}))[0].code, "nothing_near") << "both are";
}

// A vehicle with z down at a depth of 5 m, above a bed at z = -20 within its range, in a world without a
// water surface.
TEST(LookAround, SuspectsThatZIsDownIfTheBedIsInRange) {
  const char* const hint = " With the opposite sign of z, the sonar would be inside the world (is z down?).";
  render::World world = one("bed", sheet());
  Sight sight = at({7, 3, 5});
  sight.range_m = 30.0;
  auto found = look(world, {}, sight);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].code, "nothing_in_fan");
  EXPECT_TRUE(found[0].text.ends_with(hint)) << found[0].text;
  sight.sees_surface = true;
  sight.echo_over_floor = 0.01;
  found = look(world, {}, sight);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NE(found[0].text.find(hint), std::string::npos) << found[0].text;
  // A vehicle at z = -5 is in its place; one 5 m above a bed at z = 0 would be under it.
  sight = at({7, 3, -5});
  sight.range_m = 30.0;
  EXPECT_EQ(look(world, {}, sight)[0].text.find(hint), std::string::npos);
  world.bodies[0].T_world_body.position_m.z = 0.0;
  sight = at({7, 3, 5});
  EXPECT_EQ(look(world, {}, sight)[0].text.find(hint), std::string::npos);
}

/// A sonar on a vehicle whose mount is in the wrong unit.
Sight mounted(const glm::dvec3& vehicle_m, const glm::dvec3& mount_m) {
  Sight sight = at(vehicle_m);
  sight.T_world_sonar.position_m = vehicle_m + mount_m;
  return sight;
}

TEST(LookAround, BlamesTheMountThatPlacesTheSonarOutsideTheWorld) {
  // The vehicle is 4 m above the bed; the mount is in millimetres.
  EXPECT_EQ(look(one("bed", sheet()), {}, mounted({0, 0, -16}, {350, 0, 120})),
            only("nothing_near",
                 "Nothing is within 5 m; the nearest body, 'bed', is 324.6 m away. The vehicle is inside the "
                 "world, but the mount places the sonar 370 m from the vehicle: is mount.position_m in "
                 "metres?"));
  // In centimetres, below the bed.
  EXPECT_EQ(look(one("bed", sheet()), {}, mounted({0, 0, -16}, {35, 0, -12})),
            only("under_ground",
                 "The sonar is 8 m below the body 'bed', and nothing is below the sonar: is it under the bed "
                 "(the mount places the sonar 37 m from the vehicle: is mount.position_m in metres?)?"));
  EXPECT_EQ(look(pier(), {}, mounted({7, 0, -20}, {0, 0, 30})),
            only("above_surface",
                 "The sonar is 10.0 m above the water surface, in the air (the mount places the sonar 30 m "
                 "from the vehicle: is mount.position_m in metres?)."));
}

// Poses are of the vehicle: if they were read as centimetres, the sonar would still be 3 m ahead of it.
TEST(LookAround, ConvertsThePoseAndNotTheMount) {
  const auto found = look(pier(), {}, mounted({400, 0, -2000}, {3, 0, 0}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].code, "wrong_unit");
  EXPECT_NE(found[0].text.find("are positions in centimetres?"), std::string::npos) << found[0].text;
}

}  // namespace
}  // namespace sonard::server
