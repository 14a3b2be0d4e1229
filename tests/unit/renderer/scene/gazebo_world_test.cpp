// SPDX-License-Identifier: Apache-2.0
// Worlds written for Gazebo hold more than shapes: places of sonars, and elements without an echo.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/scene/world.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

const std::string head =
    "<sdf version=\"1.9\" xmlns:sonard=\"https://sonard.dev/sdf\">\n<world name=\"w\">\n";
const std::string ball_visual =
    "<visual name=\"ball\"><geometry><sphere><radius>1</radius></sphere></geometry></visual>";

World loaded(const std::string& models) {
  const test::TempFolder folder;
  return load_world(folder.write("w.sdf", head + models + "\n</world></sdf>"), {});
}

std::string load_error(const std::string& models) {
  try {
    loaded(models);
  } catch (const WorldError& error) {
    return error.what();
  }
  return "no error";
}

void expect_at(const glm::dvec3& actual, const glm::dvec3& expected) {
  EXPECT_NEAR(glm::distance(actual, expected), 0.0, 1e-9) << actual.x << " " << actual.y << " " << actual.z;
}

// An arm 1 m ahead of the origin of the vehicle, turned 90 degrees to port, with a wrist half a metre out;
// the sonar is 0.2 m above the wrist and points 0.3 rad down. The vehicle's pose in the world does not
// matter.
TEST(Sonars, HaveTheirPlaceInTheModelThatStandsInTheWorld) {
  const World world = loaded(R"(<model name="rov"><pose>10 20 -3 0 0 2</pose>
    <link name="hull">)" + ball_visual +
                             R"(</link>
    <model name="arm"><pose>1 0 0 0 0 1.5707963267948966</pose>
      <link name="wrist"><pose>0.5 0 0 0 0 0</pose>
        <sensor name="gemini" type="custom" sonard:type="gemini_720i"><pose>0 0 0.2 0 0.3 0</pose></sensor>
      </link>
    </model></model>)");
  ASSERT_EQ(world.sonars.size(), 1U);
  const WorldSonar& sonar = world.sonars[0];
  EXPECT_EQ(sonar.path, "rov::arm::wrist::gemini");
  EXPECT_EQ(sonar.type, "gemini_720i");
  EXPECT_EQ(sonar.body, "rov");
  expect_at(sonar.T_body_sonar.position_m, {1, 0.5, 0.2});
  expect_at(sonar.T_body_sonar.orientation * glm::dvec3(1, 0, 0), {0, std::cos(0.3), -std::sin(0.3)});
  expect_at(sonar.T_body_sonar.orientation * glm::dvec3(0, 1, 0), {-1, 0, 0});
  EXPECT_THAT(world.left_out, IsEmpty());
  EXPECT_THAT(world.warnings, IsEmpty());
}

TEST(Sonars, FollowTheFrameGraph) {
  const World world = loaded(R"(<model name="rov"><frame name="bow"><pose>2 0 0 0 0 0</pose></frame>
    <link name="hull"><pose>0 0 5 0 0 0</pose>)" +
                             ball_visual + R"(
      <sensor name="micron" type="custom" sonard:type="micron"><pose relative_to="bow">0 0 -1 0 0 0</pose></sensor>
    </link></model>)");
  ASSERT_EQ(world.sonars.size(), 1U);
  expect_at(world.sonars[0].T_body_sonar.position_m, {2, 0, -1});
}

/// A usual vehicle: a model of its own, in an older version of SDF, under the name that the world gives it.
TEST(Sonars, ComeWithIncludedModels) {
  const test::TempFolder folder;
  folder.write(
      "models/rov/model.sdf",
      "<sdf version=\"1.6\" xmlns:sonard=\"https://sonard.dev/sdf\"><model name=\"rov\"><link name=\"bow\">"
      "<pose>0.5 0 0 0 0 0</pose>" +
          ball_visual +
          "<sensor name=\"gemini\" type=\"custom\" sonard:type=\"gemini_720i\"><pose>0 0 0.1 0 0 0</pose>"
          "</sensor></link></model></sdf>");
  const World world = load_world(
      folder.write("w.sdf",
                   "<sdf version=\"1.6\"><world name=\"w\"><include><uri>model://rov</uri><name>rov_1</name>"
                   "<pose>7 8 9 0 0 1</pose></include></world></sdf>"),
      {});
  ASSERT_EQ(world.sonars.size(), 1U);
  EXPECT_EQ(world.sonars[0].path, "rov_1::bow::gemini");
  EXPECT_EQ(world.sonars[0].body, "rov_1");
  expect_at(world.sonars[0].T_body_sonar.position_m, {0.5, 0, 0.1});
  EXPECT_THAT(world.warnings, IsEmpty());
}

TEST(Sonars, AreRefusedInTheWrongPlace) {
  const std::string link = "<model name=\"m\"><link name=\"l\">" + ball_visual;
  EXPECT_THAT(
      load_error(link + "\n<sensor name=\"s\" type=\"custom\" sonard:typ=\"micron\"/></link></model>"),
      HasSubstr("w.sdf:4: attribute 'sonard:typ' of <sensor>"));
  EXPECT_THAT(load_error(link + "\n<sensor name=\"s\" type=\"imu\" sonard:type=\"micron\"/></link></model>"),
              HasSubstr("w.sdf:4: attribute 'sonard:type' of <sensor>"));
  EXPECT_THAT(load_error("<model name=\"m\" sonard:type=\"micron\"><link name=\"l\">" + ball_visual +
                         "</link></model>"),
              HasSubstr("w.sdf:3: attribute 'sonard:type' of <model>"));
}

TEST(LeftOut, IsListedByKind) {
  const World world = loaded(R"(<physics name="p" type="ode"><max_step_size>0.001</max_step_size></physics>
    <light name="sun" type="directional"><direction>0 0 -1</direction></light>
    <light name="lamp" type="point"/>
    <plugin name="gz::sim::systems::Physics" filename="gz-sim-physics-system"/>
    <model name="m"><link name="l">)" +
                             ball_visual + R"(
        <sensor name="eye" type="camera"/><sensor name="other" type="custom"/>
        <light name="torch" type="spot"/></link>
      <link name="door"/>
      <joint name="hinge" type="revolute"><parent>l</parent><child>door</child><axis><xyz>0 0 1</xyz></axis></joint>
      <plugin name="thruster" filename="t"/></model>)");
  EXPECT_THAT(world.left_out,
              UnorderedElementsAre("physics (1): p", "lights (3): sun, lamp, m::l::torch",
                                   "plugins (2): gz::sim::systems::Physics, m::thruster",
                                   "sensors of other kinds (2): m::l::eye (camera), m::l::other (custom)",
                                   "joints, which do not move here (1): m::hinge"));
  EXPECT_THAT(world.warnings, IsEmpty());
}

TEST(LeftOut, IsWarnedOfWhereItCouldBeHeard) {
  const std::string polyline =
      "<geometry><polyline><point>0 0</point><point>1 0</point><point>1 "
      "1</point><height>1</height></polyline>"
      "</geometry>";
  const World world =
      loaded("<model name=\"m\"><link name=\"l\">" + ball_visual + "<visual name=\"a\">" + polyline +
             "</visual><visual name=\"b\">" + polyline + "</visual></link></model>" +
             "<actor name=\"walker\"><skin><filename>w.dae</filename></skin></actor>");
  EXPECT_EQ(world.bodies.at(0).parts.size(), 1U);
  EXPECT_THAT(world.left_out, IsEmpty());
  EXPECT_THAT(world.warnings,
              UnorderedElementsAre(
                  testing::EndsWith("w.sdf: left out: shapes of geometry <polyline> (2): m::l::a, m::l::b"),
                  testing::EndsWith("w.sdf: left out: actors (1): walker")));
}

TEST(LeftOut, NamesTheFirstOfMany) {
  std::string lights;
  for (int i = 0; i < 40; ++i) {
    lights += "<light name=\"l" + std::to_string(i) + "\" type=\"point\"/>";
  }
  const World world =
      loaded(lights + "<model name=\"m\"><link name=\"l\">" + ball_visual + "</link></model>");
  EXPECT_THAT(world.left_out, ElementsAre("lights (40): l0, l1, l2, l3, l4, l5, ..."));
}

}  // namespace
}  // namespace sonard::render
