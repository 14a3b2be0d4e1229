// SPDX-License-Identifier: Apache-2.0
// Mounts that a configuration takes from its world, and the errors if the world lacks them.
#include "server/daemon/resolve_mounts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/devices/gemini/type.hpp"
#include "server/devices/micron/type.hpp"
#include "server/pose/gazebo/input.hpp"
#include "server/pose/mavlink/input.hpp"

namespace sonard::server {
namespace {

using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

auto is_problem(const std::string& key, const std::string& part) {
  return testing::AllOf(Field(&ConfigProblem::key, key), Field(&ConfigProblem::message, HasSubstr(part)));
}

class ResolveMounts : public testing::Test {
 protected:
  ResolveMounts() {
    for (const char* name : {"rov", "crab"}) {
      world_.bodies.push_back({name, {}, {}});
    }
    world_.sonars = {{"rov::bow::gemini", "gemini_720i", "rov", {{1, 2, 3}, {1, 0, 0, 0}}},
                     {"rov::bow::micron", "micron", "rov", {{0, 0, 1}, {1, 0, 0, 0}}},
                     {"crab::left::eye", "gemini_720i", "crab", {}},
                     {"crab::right::eye", "gemini_720i", "crab", {}}};
  }

  void add_gemini(const std::string& mount) {
    HeadConfig head = gemini_type().make_default();
    head.mount_from_world = mount;
    config_.heads.push_back(head);
  }
  void add_gazebo(SimulatorEntity vehicle) {
    GazeboPoseInput gazebo;
    gazebo.vehicle = std::move(vehicle);
    config_.poses.inputs.push_back(pose_input(gazebo));
  }
  SimulatorEntity vehicle_of_gazebo() const { return settings_of<GazeboPoseInput>(config_.poses)->vehicle; }
  std::vector<ConfigProblem> take() { return resolve_mounts(config_, world_); }

  render::World world_;
  DaemonConfig config_;
};

TEST_F(ResolveMounts, ChangesNothingThatIsNotAskedOfIt) {
  add_gemini("");
  add_gazebo({"boat", {"harbour"}});
  EXPECT_THAT(take(), IsEmpty());
  EXPECT_EQ(config_.heads[0].T_vehicle_sonar, render::Pose{});
  EXPECT_EQ(config_.world.vehicle_model, "");
  EXPECT_EQ(vehicle_of_gazebo().name, "boat");
  EXPECT_THAT(vehicle_of_gazebo().parents, ElementsAre("harbour"));
}

TEST_F(ResolveMounts, MountsHeadsAndFindsTheVehicle) {
  add_gemini("gemini");
  HeadConfig micron = micron_type().make_default();
  micron.mount_from_world = "rov::bow::micron";
  config_.heads.push_back(micron);
  add_gazebo({});
  EXPECT_THAT(take(), IsEmpty());
  EXPECT_EQ(config_.heads[0].T_vehicle_sonar.position_m, glm::dvec3(1, 2, 3));
  EXPECT_EQ(config_.heads[1].T_vehicle_sonar.position_m, glm::dvec3(0, 0, 1));
  EXPECT_EQ(config_.world.vehicle_model, "rov");
  EXPECT_EQ(vehicle_of_gazebo().name, "rov");
}

TEST_F(ResolveMounts, NamesWhatTheWorldHas) {
  add_gemini("oculus");
  EXPECT_THAT(take(),
              ElementsAre(is_problem("heads[0].mount.from_world",
                                     "the world has no sonar 'oculus' (expected one of rov::bow::gemini, ")));
  world_.sonars.clear();
  EXPECT_THAT(take(), ElementsAre(is_problem("heads[0].mount.from_world", "in the world")));
}

TEST_F(ResolveMounts, WantsOneSonarOfTheRightTypeOnOneVehicle) {
  add_gemini("eye");
  add_gemini("micron");
  EXPECT_THAT(
      take(),
      ElementsAre(
          is_problem("heads[0].mount.from_world", "(expected one of crab::left::eye, crab::right::eye)"),
          is_problem("heads[1].mount.from_world", "has type micron in the world (expected gemini_720i")));
  config_ = {};
  add_gemini("gemini");
  add_gemini("left::eye");
  EXPECT_THAT(take(), ElementsAre(is_problem("heads[1].mount.from_world",
                                             "on model 'crab', but the vehicle is 'rov'")));
}

TEST_F(ResolveMounts, WantsAVehicleThatIsThere) {
  config_.world.vehicle_model = "boat";
  EXPECT_THAT(take(), ElementsAre(is_problem("world.vehicle_model", "no model 'boat'")));
  config_ = {};
  add_gemini("");
  config_.heads[0].hides_vehicle = true;
  add_gazebo({});
  EXPECT_THAT(take(), ElementsAre(is_problem("heads[0].hides_vehicle", "expected world.vehicle_model"),
                                  is_problem("poses.gazebo.vehicle", "expected the name of an entity")));
  config_.world.vehicle_model = "rov";
  EXPECT_THAT(take(), IsEmpty());
  EXPECT_EQ(vehicle_of_gazebo().name, "rov");
}

TEST_F(ResolveMounts, PlacesMavlinkOnEarth) {
  MavlinkPoseInput mavlink;
  mavlink.messages = MavlinkMessages::global_position;
  config_.poses.inputs.push_back(pose_input(mavlink));
  EXPECT_THAT(take(),
              ElementsAre(is_problem("poses.mavlink.messages",
                                     "requires the position of the world on Earth (expected world.origin")));
  world_.origin = render::GeographicOrigin{43.0, 5.0, 0.0};
  EXPECT_THAT(take(), IsEmpty());
  EXPECT_EQ(settings_of<MavlinkPoseInput>(config_.poses)->world_origin.value().latitude_deg, 43.0);
}

}  // namespace
}  // namespace sonard::server
