// SPDX-License-Identifier: Apache-2.0
// Entities of a simulator as vehicle and bodies. The expected poses were derived from the geometry by hand.
#include "server/pose/gazebo/entity_poses.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace sonard::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const double half_root = std::sqrt(0.5);
const pose::Quat quarter_to_port{half_root, 0, 0, half_root};

pose::NamedTransform at(const std::string& name, double x, double y, double z, pose::Quat q = {}) {
  return {name, {{x, y, z}, q}};
}

EntityPoses message(std::vector<pose::NamedTransform> entities) {
  return {std::int64_t{5'000'000'000}, std::move(entities)};
}

GazeboPoseInput follow(const std::string& vehicle, std::vector<std::string> parents = {}) {
  GazeboPoseInput input;
  input.vehicle = {vehicle, std::move(parents)};
  return input;
}

void expect_position(const pose::Transform& T, double x, double y, double z) {
  EXPECT_NEAR(T.position_m.x, x, 1e-12);
  EXPECT_NEAR(T.position_m.y, y, 1e-12);
  EXPECT_NEAR(T.position_m.z, z, 1e-12);
}

std::string refusal(EntityMap map, const EntityPoses& poses) {
  const auto sample = map.map(poses);
  return sample ? "" : sample.error();
}

TEST(EntityMap, TakesAWorldPoseAsItIs) {
  EntityMap map{follow("rov")};
  const auto sample = map.map(message({at("rov", 1, 2, -3, quarter_to_port)}));
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->time_ns, 5'000'000'000);
  expect_position(sample->T_world_vehicle, 1, 2, -3);
  EXPECT_NEAR(sample->T_world_vehicle.orientation.z, half_root, 1e-12);
  EXPECT_FALSE(sample->twist);
}

TEST(EntityMap, MountsTheVehicleInTheAxesOfTheEntity) {
  GazeboPoseInput input = follow("rov");
  input.T_entity_vehicle.position_m = {2, 0, 0};  // ahead, which is north after a quarter turn
  EntityMap map{input};
  const auto sample = map.map(message({at("rov", 1, 2, -3, quarter_to_port)}));
  ASSERT_TRUE(sample);
  expect_position(sample->T_world_vehicle, 1, 4, -3);
}

TEST(EntityMap, ComposesRelativePosesFromTheOutermostParentInwards) {
  EntityMap map{follow("sonar", {"rov", "arm"})};
  // The vehicle's forward is north. The arm is turned by another quarter, so its forward is west.
  const auto sample = map.map(message(
      {at("sonar", 1, 0, 0), at("arm", 2, 0, 0, quarter_to_port), at("rov", 10, 20, -30, quarter_to_port)}));
  ASSERT_TRUE(sample);
  expect_position(sample->T_world_vehicle, 9, 22, -30);
  EXPECT_NEAR(std::abs(sample->T_world_vehicle.orientation.z), 1.0, 1e-12) << "half a turn in all";
}

TEST(EntityMap, NamesBodiesAsOurWorldDoesAndLeavesOutThoseThatAreNotThere) {
  GazeboPoseInput input = follow("rov");
  input.bodies = {{{"fish_3", {}}, "fish"}, {{"hand", {"rov"}}, "gripper"}, {{"absent", {}}, "absent"}};
  EntityMap map{input};
  const auto sample =
      map.map(message({at("rov", 0, 0, -5, quarter_to_port), at("fish_3", 7, 8, 9), at("hand", 1, 0, 0)}));
  ASSERT_TRUE(sample);
  ASSERT_EQ(sample->bodies.size(), 2U);
  EXPECT_EQ(sample->bodies[0].name, "fish");
  expect_position(sample->bodies[0].T_world_body, 7, 8, 9);
  EXPECT_EQ(sample->bodies[1].name, "gripper");
  expect_position(sample->bodies[1].T_world_body, 0, 1, -5);
}

TEST(EntityMap, TellsOnceOfEntitiesThatAreNotConfigured) {
  EntityMap map{follow("rov")};
  const EntityPoses poses = message({at("rov", 0, 0, 0), at("crab", 0, 0, 0), at("buoy", 0, 0, 0)});
  ASSERT_TRUE(map.map(poses));
  EXPECT_THAT(map.take_ignored(), ElementsAre("crab", "buoy"));
  ASSERT_TRUE(map.map(poses));
  EXPECT_THAT(map.take_ignored(), IsEmpty());
}

TEST(EntityMap, RefusesWhatWouldPutTheSonarInAWrongPlace) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal(EntityMap{follow("rov")}, message({at("crab", 0, 0, 0)})), "entity 'rov' is not in it");
  EXPECT_EQ(refusal(EntityMap{follow("link", {"rov"})}, message({at("link", 0, 0, 0)})),
            "entity 'rov' is not in it");
  EXPECT_EQ(refusal(EntityMap{follow("link")}, message({at("link", 0, 0, 0), at("link", 1, 0, 0)})),
            "entity 'link' is in it more than once");
  EXPECT_THAT(refusal(EntityMap{follow("rov")}, message({at("rov", nan, 0, 0)})), HasSubstr("finite"));
  EXPECT_THAT(refusal(EntityMap{follow("rov")}, message({at("rov", 0, 0, 0, {0, 0, 0, 0})})),
              HasSubstr("orientation"));
  EntityPoses unstamped = message({at("rov", 0, 0, 0)});
  unstamped.time_ns.reset();
  EXPECT_THAT(refusal(EntityMap{follow("rov")}, unstamped), HasSubstr("no time stamp"));
  EntityPoses far_future = message({at("rov", 0, 0, 0)});
  far_future.time_ns = pose::max_time_ns + 1;
  EXPECT_THAT(refusal(EntityMap{follow("rov")}, far_future), HasSubstr("out of range"));
}

}  // namespace
}  // namespace sonard::server
