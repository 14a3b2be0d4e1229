// SPDX-License-Identifier: Apache-2.0
// Models without an echo do not stop a world, and a missing file removes only its own shape or model.
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/scene/world.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::string a_box = "<visual name=\"v\"><geometry><box><size>1 1 1</size></box></geometry></visual>";
const std::string boxed_link = "<link name=\"l\">" + a_box + "</link>";
const std::string post = "<model name=\"post\"><pose>5 0 0 0 0 0</pose>" + boxed_link + "</model>";

class WithoutModels : public testing::Test {
 protected:
  World load(const std::string& content, MissingFiles missing = MissingFiles::skip) const {
    return load_world(
        folder_.write("w.sdf", "<sdf version=\"1.9\">\n<world name=\"w\">\n" + content + "\n</world></sdf>"),
        {}, missing);
  }

  test::TempFolder folder_;
};

glm::dvec3 place_of(const World& world, const char* body) {
  const Body* const found = world.find_body(body);
  return found == nullptr ? glm::dvec3(1e9) : found->T_world_body.position_m;
}

TEST_F(WithoutModels, AModelOfNothingIsABody) {
  const World world =
      load(post +
               "<model name=\"marks\"><static>true</static><frame name=\"f\"><pose>1 0 0 0 0 0</pose></frame>"
               "</model><model name=\"bare\"/><model name=\"nest\"><model name=\"egg\"/></model>"
               "<model name=\"imu\"><link name=\"l\"><sensor name=\"s\" type=\"imu\"/></link></model>"
               "<model name=\"plug\"><plugin name=\"p\" filename=\"f\"/></model>",
           MissingFiles::error);
  EXPECT_THAT(world.warnings, IsEmpty());
  EXPECT_EQ(world.bodies.size(), 6U);
  EXPECT_THAT(world.left_out, Contains("models without shapes (5): marks, bare, nest, imu, plug"));
}

TEST_F(WithoutModels, AWorldMayBeWithoutTriangles) {
  EXPECT_EQ(load("<model name=\"m\"><link name=\"l\"/></model>").triangle_count(), 0U);
  EXPECT_EQ(load("").triangle_count(), 0U);
}

TEST_F(WithoutModels, CollisionShapesAreUsedOnlyIfThereAreSome) {
  const World world = load(
      "<model name=\"hull\"><link name=\"l\"><collision name=\"c\"><geometry><box><size>1 1 1</size>"
      "</box></geometry></collision></link></model><model name=\"frame\"><frame name=\"f\"/></model>");
  EXPECT_THAT(world.warnings,
              ElementsAre(HasSubstr("w.sdf:3: hull: the model has no visual: its collision shapes")));
}

TEST_F(WithoutModels, AnIncludeThatIsSkippedLeavesItsModelEmpty) {
  const std::string course = "<model name=\"course\">\n<include><uri>model://buoy</uri></include></model>";
  EXPECT_THROW(load(post + course, MissingFiles::error), WorldError);
  const World world = load(post + course);
  EXPECT_THAT(world.warnings, ElementsAre(HasSubstr("w.sdf:4: include 'model://buoy' not found")));
  EXPECT_EQ(world.bodies.size(), 2U);
  EXPECT_EQ(world.triangle_count(), 12U);
}

TEST_F(WithoutModels, SkippingReachesIntoModelsInModels) {
  folder_.write("models/rig/model.sdf",
                "<sdf version=\"1.9\"><model name=\"rig\">" + boxed_link +
                    "<model name=\"arm\"><include><uri>gone_hand</uri></include></model>"
                    "<include merge=\"true\"><uri>model://gone_skid</uri></include></model></sdf>");
  const World world = load(
      "<model name=\"outer\"><model name=\"inner\"><include><uri>model://rig</uri></include>"
      "<include><uri>file://gone_lamp/model.sdf</uri></include></model></model>");
  EXPECT_THAT(world.warnings,
              testing::UnorderedElementsAre(HasSubstr("'gone_hand' not found"),
                                            HasSubstr("'model://gone_skid' not found"),
                                            HasSubstr("'file://gone_lamp/model.sdf' not found")));
  EXPECT_EQ(world.triangle_count(), 12U);
}

// The missing include has a pose, and a crate is placed relative to it: at (10, 2, 0) + (0, 0, 1).
TEST_F(WithoutModels, WhatStandsByASkippedIncludeHasItsPlace) {
  const World world = load(
      "<include><uri>model://buoy</uri><pose>10 2 0 0 0 0</pose></include>"
      "<model name=\"crate\"><pose relative_to=\"buoy\">0 0 1 0 0 0</pose>" +
      boxed_link + "</model>");
  EXPECT_EQ(place_of(world, "crate"), glm::dvec3(10, 2, 1));
  EXPECT_THAT(world.warnings, ElementsAre(HasSubstr("'model://buoy' not found")));
  EXPECT_EQ(world.find_body("buoy"), nullptr);
}

TEST_F(WithoutModels, WhatStandsByAPartOfASkippedIncludeIsSkipped) {
  const std::string world_text =
      post +
      "<include><name>b</name><uri>model://buoy</uri></include>\n"
      "<model name=\"crate\"><pose relative_to=\"b::top\">0 0 1 0 0 0</pose>" +
      boxed_link +
      "</model>\n"
      "<model name=\"rig\"><include merge=\"true\"><uri>model://skid</uri></include><link name=\"a\">" +
      a_box + "</link>\n<link name=\"b\"><pose relative_to=\"skid_top\"/>" + a_box + "</link></model>";
  const World world = load(world_text);
  EXPECT_EQ(world.find_body("crate"), nullptr);
  EXPECT_EQ(world.triangle_count(), 24U) << "the post and link a";
  EXPECT_THAT(
      world.warnings,
      AllOf(Contains(HasSubstr("w.sdf:4: frame 'b::top' is in the model 'b', which is missing")),
            Contains(HasSubstr("w.sdf:6: frame 'skid_top' is in a model to be merged, which is missing"))));
  try {
    load(world_text, MissingFiles::error);
    FAIL() << "nothing is missing";
  } catch (const WorldError& error) {
    EXPECT_THAT(error.what(), HasSubstr("include 'model://buoy' not found"));
    EXPECT_THAT(error.more, ElementsAre(HasSubstr("include 'model://skid' not found")))
        << "and not what follows";
  }
}

/// A git submodule that was not fetched leaves such a folder.
TEST_F(WithoutModels, AFolderWithoutAModelIsNotThere) {
  folder_.write("models/buoy/README", "");
  const World world =
      load(post + "<include><uri>model://buoy</uri></include><include><uri>models/buoy</uri></include>");
  EXPECT_THAT(
      world.warnings,
      ElementsAre(testing::ContainsRegex("include 'model://buoy': file .*models/buoy/model.sdf not found"),
                  HasSubstr("include 'models/buoy': file ")));
}

TEST_F(WithoutModels, AMeshOfNothingTakesItsShapeAlong) {
  folder_.write("empty.stl", "solid empty\nendsolid empty\n");
  folder_.write("wing.stl",
                "solid wing\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                "endloop\nendfacet\nendsolid wing\n");
  const auto with = [](const std::string& mesh) {
    return post + "<model name=\"m\"><link name=\"l\"><visual name=\"v\"><geometry><mesh>" + mesh +
           "</mesh></geometry></visual></link></model>";
  };
  for (const auto& [mesh, says] :
       {std::pair<std::string, std::string>("<uri>empty.stl</uri>", "empty.stl: the mesh has no triangles"),
        {"<uri>wing.stl</uri><submesh><name>tail</name></submesh>",
         "wing.stl: no submesh 'tail' with triangles; names in the file: wing"}}) {
    const World world = load(with(mesh));
    EXPECT_THAT(world.warnings, ElementsAre(AllOf(HasSubstr("shapes are left out: "), HasSubstr(says))));
    EXPECT_EQ(world.triangle_count(), 12U);
    try {
      load(with(mesh), MissingFiles::error);
      ADD_FAILURE() << "is refused unless told otherwise";
    } catch (const WorldError& error) {
      EXPECT_THAT(error.what(),
                  AllOf(HasSubstr(says), HasSubstr("load the world without it: `world: {missing: skip}`")));
    }
  }
}

/// Exporters on other machines write such paths.
TEST_F(WithoutModels, APathOfAnotherMachineIsMissing) {
  const auto visual = [](const std::string& shape) {
    return "<model name=\"m\"><link name=\"l\"><visual name=\"v\"><geometry>" + shape +
           "</geometry></visual></link></model>";
  };
  folder_.write("models/buoy/model.config", "<model><sdf>/home/alice/buoy.sdf</sdf></model>");
  for (const std::string uri :
       {"/home/alice/ws/x/hull.dae", "file:///home/alice/ws/x/hull.dae", "file:///C:/Users/me/p.obj",
        "C:\\Users\\me\\p.obj", "../other/hull.dae", "model://../hull.dae", "model:///post/hull.dae"}) {
    for (const std::string& content :
         {visual("<mesh><uri>" + uri + "</uri></mesh>"),
          visual("<heightmap><uri>" + uri + "</uri><size>1 1 1</size></heightmap>"),
          "<include><uri>" + uri + "</uri></include>"}) {
      const World world = load(post + content);
      EXPECT_EQ(world.triangle_count(), 12U) << content;
      EXPECT_THAT(world.warnings, ElementsAre(HasSubstr("'" + uri + "' not found"))) << content;
      EXPECT_THROW(load(post + content, MissingFiles::error), WorldError) << content;
    }
  }
  EXPECT_THAT(load(post + "<include><uri>buoy</uri></include>").warnings,
              ElementsAre(HasSubstr("'buoy': file /home/alice/buoy.sdf not found")));
}

/// A file that exists is a mistake that the user can correct.
TEST_F(WithoutModels, AFileOutsideOfTheFoldersIsRefused) {
  for (const std::string uri : {"/etc/passwd", "file:///etc/passwd"}) {
    EXPECT_THROW(load(post + "<include><uri>" + uri + "</uri></include>"), WorldError) << uri;
  }
}

TEST_F(WithoutModels, AMissingHeightmapTakesItsShapeAlong) {
  const World world = load(
      "<model name=\"bed\"><link name=\"l\">" + a_box +
      "<visual name=\"h\"><geometry><heightmap><uri>file://gone.png</uri></heightmap></geometry></visual>"
      "<visual name=\"n\"><geometry><heightmap><size>1 1 1</size></heightmap></geometry></visual>"
      "<visual name=\"m\"><geometry><mesh><uri>__default__</uri></mesh></geometry></visual></link></model>");
  EXPECT_EQ(world.triangle_count(), 12U);
  EXPECT_THAT(world.warnings,
              testing::UnorderedElementsAre(
                  testing::AllOf(HasSubstr("w.sdf:3: shapes are left out: 'file://gone.png' not found"),
                                 HasSubstr("(1): bed::l::h")),
                  HasSubstr("shapes are left out: the URI is missing (2): bed::l::n, bed::l::m")));
}

}  // namespace
}  // namespace sonard::render
