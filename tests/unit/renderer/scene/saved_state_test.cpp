// SPDX-License-Identifier: Apache-2.0
// Worlds that Gazebo Classic saved: bodies have the poses of <state>, as after Gazebo has loaded them. The
// rules are in renderer/scene/sdf_state.hpp; places and sizes are computed by hand.
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/scene/world.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string shaped(const std::string& name, const std::string& shape, const std::string& pose = "") {
  return "<visual name=\"" + name + "\">" + pose + "<geometry>" + shape + "</geometry></visual>";
}

const std::string saved_box = shaped("v", "<box><size>1 2 3</size></box>");

World loaded_state(const std::string& models, const std::string& state) {
  const test::TempFolder folder;
  folder.write("quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 1\nf 1 2 3\n");
  return load_world(folder.write("w.world", "<sdf version='1.6'>\n<world name='default'>\n" + models +
                                                "\n<state world_name='default'><sim_time>5 2</sim_time>" +
                                                state + "</state>\n</world></sdf>"),
                    {});
}

glm::dvec3 in_world(const World& world, std::size_t body, std::size_t part, const glm::dvec3& p = {0, 0, 0}) {
  return world.bodies.at(body).T_world_body * (world.bodies.at(body).parts.at(part).T_body_part * p);
}

void expect_place(const glm::dvec3& actual, const glm::dvec3& expected) {
  EXPECT_NEAR(glm::distance(actual, expected), 0.0, 1e-9) << actual.x << " " << actual.y << " " << actual.z;
}

glm::dvec3 size_of(const World& world, std::size_t part) {
  const test::Bounds box = test::bounds(*world.bodies.at(0).parts.at(part).mesh);
  return box.high - box.low;
}

// The file has the cart at (1, 0, 0), with a wheel 0.5 m below. It has rolled to (4, 2, 0) and turned to port
// by a quarter; the wheel is 0.2 m ahead (now along y) of its place.
TEST(SavedWorld, HasModelsAndLinksWhereTheyWereSaved) {
  const World world = loaded_state(
      "<model name='cart'><pose>1 0 0 0 -0 0</pose><link name='body'>" + saved_box +
          "</link><link name='wheel'><pose>0 0 -0.5 0 -0 0</pose>" +
          shaped("v", "<sphere><radius>0.2</radius></sphere>", "<pose>0 0.1 0 0 0 0</pose>") +
          "</link></model>",
      "<model name='cart'><pose frame=''>4 2 0 0 -0 1.5707963267948966</pose><scale>1 1 1</scale>"
      "<link name='body'><pose frame=''>4 2 0 0 -0 1.5707963267948966</pose><velocity>0 0 0 0 -0 "
      "0</velocity></link>"
      "<link name='wheel'><pose frame=''>4 2.2 -0.5 0 -0 1.5707963267948966</pose></link></model>");
  expect_place(world.bodies.at(0).T_world_body.position_m, {4, 2, 0});
  expect_place(in_world(world, 0, 0, {1, 0, 0}), {4, 3, 0});
  expect_place(in_world(world, 0, 1),
               {3.9, 2.2, -0.5});  // its visual is 0.1 m to port of the link: along -x now
  EXPECT_THAT(world.warnings, IsEmpty());
  EXPECT_THAT(world.left_out, ElementsAre("poses of models for which <state> has others (1): cart"));
}

// A link or nested model that the state does not list moves with its model. The pose of a listed one is in
// the world.
TEST(SavedWorld, HasNestedModelsWhereTheyWereSaved) {
  const std::string rig =
      "<model name='rig'><pose>1 0 0 0 0 0</pose><link name='base'>" + saved_box +
      "</link><model name='arm'><pose>0 0 1 0 0 0</pose><link name='hand'><pose>0.5 0 0 0 0 0</pose>" +
      saved_box + "</link></model></model>";
  const World moved = loaded_state(rig, "<model name='rig'><pose>10 0 0 0 0 0</pose></model>");
  expect_place(in_world(moved, 0, 0), {10, 0, 0});
  expect_place(in_world(moved, 0, 1), {10.5, 0, 1});
  const World both = loaded_state(rig,
                                  "<model name='rig'><pose>10 0 0 0 0 0</pose><model name='arm'>"
                                  "<pose>10 3 1 0 0 3.141592653589793</pose></model></model>");
  expect_place(in_world(both, 0, 1), {9.5, 3, 1});
  const World hand = loaded_state(rig,
                                  "<model name='rig'><pose>10 0 0 0 0 0</pose><model name='arm'>"
                                  "<pose>10 3 1 0 0 0</pose><link name='hand'><pose>7 7 7 0 0 0</pose></link>"
                                  "</model></model>");
  expect_place(in_world(hand, 0, 1), {7, 7, 7});
}

TEST(SavedWorld, HasFlattenedLinksWhereTheyWereSaved) {
  const World world = loaded_state("<model name='rig'><link name='arm::tip'>" + saved_box + "</link></model>",
                                   "<model name='rig'><pose>1 1 1 0 0 0</pose><link name='arm::tip'>"
                                   "<pose>2 3 4 0 0 0</pose></link></model>");
  expect_place(world.bodies.at(0).T_world_body.position_m, {1, 1, 1});
  expect_place(in_world(world, 0, 0), {2, 3, 4});
}

// The scale changes sizes only, in the axes of each shape: the radius of a sphere by the greatest factor, the
// radius of a cylinder by the greater of x and y. Distances in the model stay.
TEST(SavedWorld, HasShapesInTheirSavedScale) {
  const World world = loaded_state(
      "<model name='m'><link name='l'><pose>5 0 0 0 0 0</pose>" + saved_box +
          shaped("b", "<sphere><radius>1</radius></sphere>") +
          shaped("c", "<cylinder><radius>1</radius><length>1</length></cylinder>") +
          shaped("d", "<mesh><uri>quad.obj</uri><scale>1 1 10</scale></mesh>") +
          shaped("e", "<plane><normal>0 0 1</normal><size>4 4</size></plane>") + "</link></model>",
      "<model name='m'><pose>0 0 0 0 0 0</pose><scale>2 3 0.5</scale></model>");
  expect_place(size_of(world, 0), {2, 6, 1.5});
  EXPECT_NEAR(glm::distance(size_of(world, 1), {6, 6, 6}), 0.0, 0.02);
  EXPECT_NEAR(glm::distance(size_of(world, 2), {6, 6, 0.5}), 0.0, 0.02);
  EXPECT_EQ(world.bodies[0].parts[3].scale, glm::dvec3(2, 3, 5));
  expect_place(size_of(world, 4), {4, 4, 0});
  expect_place(in_world(world, 0, 0), {5, 0, 0});
}

TEST(SavedWorld, HasWhatWasInsertedAndNotWhatWasDeleted) {
  const World world =
      loaded_state("<model name='old'><link name='l'>" + saved_box + "</link></model>",
                   "<insertions><model name='new'><pose>3 0 0 0 0 0</pose><link name='l'>" + saved_box +
                       "</link></model><model name='moved'><link name='l'>" + saved_box +
                       "</link></model></insertions><deletions><name>old</name></deletions>"
                       "<model name='moved'><pose>0 8 0 0 0 0</pose></model>");
  ASSERT_EQ(world.bodies.size(), 2U);
  EXPECT_EQ(world.bodies[0].name, "new");
  expect_place(in_world(world, 0, 0), {3, 0, 0});
  expect_place(in_world(world, 1, 0), {0, 8, 0});
  EXPECT_THAT(world.warnings, IsEmpty());
}

TEST(SavedWorld, SaysWhichPosesHaveNoModel) {
  const World world =
      loaded_state("<model name='m'><link name='l'>" + saved_box + "</link></model>",
                   "<model name='gone'><pose>1 2 3 0 0 0</pose></model><model name='m'><pose>1 0 0 0 0 0"
                   "</pose><link name='wheel'><pose>1 0 0 0 0 0</pose></link></model>");
  EXPECT_THAT(world.warnings,
              ElementsAre(HasSubstr("w.world:4: <state> has poses of 2 models or links that are not in "
                                    "this world: gone, m::wheel; save the world again")));
}

TEST(SavedWorld, NamesTheLineOfAPoseThatIsNone) {
  try {
    loaded_state("<model name='m'><link name='l'>" + saved_box + "</link></model>",
                 "\n<model name='m'><pose>1 2 3</pose></model>");
    FAIL() << "no error";
  } catch (const WorldError& error) {
    EXPECT_THAT(error.what(), HasSubstr("w.world:5: pose '1 2 3': expected 6 numbers"));
  }
}

// A visual that is placed by a frame of the model keeps its place in its link.
TEST(SavedWorld, MovesWhatAFrameHasPlacedWithItsLink) {
  const World world = loaded_state(
      "<model name='m'><frame name='f'><pose>0 0 2 0 0 0</pose></frame><link name='l'>"
      "<pose>1 0 0 0 0 0</pose>" +
          shaped("v", "<box><size>1 1 1</size></box>", "<pose relative_to='f'>0 0 0 0 0 0</pose>") +
          "</link></model>",
      "<model name='m'><pose>0 0 0 0 0 0</pose><link name='l'><pose>1 0 5 0 0 0</pose></link>"
      "</model>");
  expect_place(in_world(world, 0, 0), {0, 0, 7});
}

}  // namespace
}  // namespace sonard::render
