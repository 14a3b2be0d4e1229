// SPDX-License-Identifier: Apache-2.0
// Shapes without a surface and values for other sensors never stop a world.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/scene/world.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ShapesOfNothing : public testing::Test {
 protected:
  /// @param visual content of the visual; the world also has a ball
  World load(const std::string& visual) const {
    folder_.write("quad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    return load_world(
        folder_.write("w.sdf",
                      "<sdf version=\"1.9\"><world name=\"w\"><model name=\"m\"><link name=\"l\">\n"
                      "<visual name=\"v\">" +
                          visual +
                          "</visual>\n<visual name=\"ball\"><geometry><sphere/></geometry></visual>"
                          "</link></model></world></sdf>"),
        {});
  }
  void expect_left_out(const std::string& visual, const std::string& why) const {
    SCOPED_TRACE(visual);
    const World world = load(visual);
    EXPECT_EQ(world.bodies.at(0).parts.size(), 1U) << "only the ball";
    EXPECT_THAT(world.warnings,
                ElementsAre(AllOf(HasSubstr("w.sdf:2: a shape without a surface is left out: " + why),
                                  HasSubstr("(1): m::l::v"))));
  }
  static std::string geometry(const std::string& shape) { return "<geometry>" + shape + "</geometry>"; }

  test::TempFolder folder_;
};

TEST_F(ShapesOfNothing, AreLeftOutIfTheyHaveNoGeometry) {
  expect_left_out("", "its <geometry> is missing or empty");
  expect_left_out("<geometry/>", "its <geometry> is missing or empty");
  const World world = load("<geometry><empty/></geometry>");
  EXPECT_THAT(world.warnings, IsEmpty());
}

TEST_F(ShapesOfNothing, AreLeftOutIfTheirSizeIsZero) {
  expect_left_out(geometry("<cylinder><radius>0</radius><length>2</length></cylinder>"), "radius is 0");
  expect_left_out(geometry("<sphere><radius>0.0</radius></sphere>"), "radius is 0");
  expect_left_out(geometry("<box><size>0 0 0</size></box>"), "two sides of the box are 0");
  expect_left_out(geometry("<plane><size>0 0</size></plane>"), "plane size is 0");
  expect_left_out(geometry("<mesh><uri>quad.obj</uri><scale>1 1 0</scale></mesh>"),
                  "a number of the <scale> of its mesh is 0");
}

TEST_F(ShapesOfNothing, AreNoPlates) {
  const World world = load(geometry("<box><size>2 2 0</size></box>"));
  EXPECT_EQ(world.bodies.at(0).parts.size(), 2U);
  EXPECT_THAT(world.warnings, IsEmpty());
}

// <laser_retro> is meant for a laser.
TEST(LaserRetro, IsNotUsedIfItMeansNothing) {
  const test::TempFolder folder;
  for (const std::string value : {"-1", "bright"}) {
    const World world =
        load_world(folder.write("w.sdf",
                                "<sdf version=\"1.9\"><world name=\"w\"><model name=\"m\"><link name=\"l\">\n"
                                "<visual name=\"v\"><geometry><sphere/></geometry><laser_retro>" +
                                    value + "</laser_retro></visual></link></model></world></sdf>"),
                   {});
    EXPECT_EQ(world.bodies.at(0).parts.at(0).material.name, "default");
    EXPECT_THAT(world.warnings, ElementsAre(AllOf(HasSubstr("w.sdf:2: laser_retro is not used"),
                                                  HasSubstr("(1): " + value + " (m::l::v)"))));
  }
}

}  // namespace
}  // namespace sonard::render
