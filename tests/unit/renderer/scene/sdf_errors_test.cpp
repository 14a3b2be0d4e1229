// SPDX-License-Identifier: Apache-2.0
// Error messages of wrong worlds: each names the file, the line and the element.
#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/scene/world.hpp"
#include "tests/support/without_rights.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string shape = "<geometry><sphere><radius>1</radius></sphere></geometry>";

std::string error_of_world(const std::filesystem::path& file) {
  try {
    load_world(file, {SONARD_SOURCE_DIR "/tests/data/worlds"});
  } catch (const WorldError& error) {
    return error.what();
  }
  return "no error";
}

struct Case {
  const char* name;
  std::string world;  ///< children of <world>, from line 3 on
  std::vector<std::string> expected;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

std::string model(const std::string& visual_content) {
  return "<model name=\"m\"><link name=\"l\">\n<visual name=\"v\">" + visual_content +
         "</visual></link></model>";
}

class BadWorld : public testing::TestWithParam<Case> {};

TEST_P(BadWorld, IsNamedWithItsPlace) {
  const test::TempFolder folder;
  folder.write("quad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("points.obj", "v 0 0 0\nv 1 1 1\n");
  folder.write("n.png", "not a picture");
  folder.write("broken/model.sdf",
               "<sdf version=\"1.9\"><model name=\"b\"><link name=\"l\">\n<visual name=\"v\">" + shape +
                   "</visual></link>\n<include><uri>model://gone</uri></include></model></sdf>");
  const auto file =
      folder.write("world.sdf", "<sdf version=\"1.9\" xmlns:sonard=\"x\">\n<world name=\"w\">\n" +
                                    GetParam().world + "\n</world></sdf>");
  const std::string message = error_of_world(file);
  for (const std::string& part : GetParam().expected) {
    EXPECT_THAT(message, HasSubstr(part));
  }
  EXPECT_EQ(message.find('\n'), std::string::npos) << "one line";
  EXPECT_EQ(message.find('\033'), std::string::npos) << "no colours";
}

const std::vector<Case> cases{
    {"missing_mesh",
     model("<geometry><mesh><uri>hull.obj</uri></mesh></geometry>"),
     {"world.sdf:4: m::l::v: 'hull.obj' not found; looked in /"}},
    {"missing_model",
     "<include><uri>model://gone</uri></include>",
     {"world.sdf:3: ", "'model://gone' not found; looked in /"}},
    {"missing_in_include", "<include><uri>broken</uri></include>", {"broken/model.sdf:3: ", "model://gone"}},
    {"url_mesh",
     model("<geometry><mesh><uri>http://127.0.0.1/hull.obj</uri></mesh></geometry>"),
     {"world.sdf:4: m::l::v: 'http://127.0.0.1/hull.obj': sonard downloads nothing"}},
    {"url_include",
     "<include><uri>https://fuel.gazebosim.org/1.0/a/models/b</uri></include>",
     {"world.sdf:3: ", "is not in the local cache of Fuel; looked in /", "gz fuel download -u https://"}},
    {"url_of_another",
     "<include><uri>https://example.org/models/b</uri></include>",
     {"world.sdf:3: ", "sonard downloads nothing"}},
    {"unknown_format",
     model("<geometry><mesh><uri>world.sdf</uri></mesh></geometry>"),
     {"world.sdf:4: m::l::v: ", "'sdf' is not a supported mesh format", "obj, stl, ply, dae"}},
    {"zero_triangles",
     model("<geometry><mesh><uri>points.obj</uri></mesh></geometry>"),
     {"world.sdf:4: m::l::v: ", "points.obj: "}},
    {"unknown_material",
     model(shape + "<sonard:material>conrete</sonard:material>"),
     {"world.sdf:4: m::l::v: unknown material 'conrete' (did you mean 'concrete'?)"}},
    {"unknown_material_above",
     "<model name=\"m\">\n<sonard:material>conrete</sonard:material><link name=\"l\"><visual name=\"v\">" +
         shape + "</visual></link></model>",
     {"m::l::v: from <model> at ", "world.sdf:3: unknown material 'conrete'"}},
    {"negative_reflectance",
     model(shape + "<sonard:material reflectance=\"-1\"/>"),
     {"world.sdf:4: m::l::v: reflectance is -1"}},
    {"reflectance_no_number",
     model(shape + "<sonard:material reflectance=\"high\"/>"),
     {"world.sdf:4: m::l::v: reflectance 'high': expected a number"}},
    {"rms_slope_out_of_range",
     model(shape + "<sonard:material rms_slope=\"2\">steel</sonard:material>"),
     {"world.sdf:4: m::l::v: rms_slope is 2: expected a number from 0.01 to 0.5"}},
    {"misspelt_attribute",
     model(shape + "<sonard:material refletance=\"1\">steel</sonard:material>"),
     {"world.sdf:4: <sonard:material> has no attribute 'refletance'"}},
    {"misspelt_element",
     model(shape + "<sonard:materiel>steel</sonard:materiel>"),
     {"world.sdf:4: unknown element <sonard:materiel>"}},
    {"misplaced_element",
     model("<geometry><sphere><radius>1</radius></sphere><sonard:material>mud</sonard:material></geometry>"),
     {"world.sdf:4: <sonard:material> inside <geometry>"}},
    {"two_materials",
     model(shape + "<sonard:material>mud</sonard:material><sonard:material>mud</sonard:material>"),
     {"world.sdf:4: <sonard:material> is given twice"}},
    {"empty_material",
     model(shape + "<sonard:material/>"),
     {"world.sdf:4: m::l::v: <sonard:material> is empty"}},
    {"water_surface_no_number",
     "<sonard:water_surface_z>high</sonard:water_surface_z>" + model(shape),
     {"world.sdf:3: sonard:water_surface_z 'high': expected a number"}},
    {"negative_radius",
     model("<geometry><sphere><radius>-1</radius></sphere></geometry>"),
     {"world.sdf:4: m::l::v: radius is -1"}},
    {"radius_no_number",
     model("<geometry><sphere><radius>one</radius></sphere></geometry>"),
     {"world.sdf:4: ", "radius"}},
    {"no_such_submesh",
     model("<geometry><mesh><uri>quad.obj</uri><submesh><name>keel</name></submesh></mesh></geometry>"),
     {"world.sdf:4: m::l::v: ", "quad.obj: no submesh 'keel'"}},
    {"missing_with_steps",
     model("<geometry><mesh><uri>hull.obj</uri></mesh></geometry>"),
     {"; to search other folders, set GZ_SIM_RESOURCE_PATH; correct it, or load the world without it: "
      "`world: {missing: skip}`"}},
    {"file_of_fuel",
     model("<geometry><mesh><uri>https://fuel.gazebosim.org/1.0/a/models/b/3/files/c.obj</uri></mesh></"
           "geometry>"),
     {"`gz fuel download -u https://fuel.gazebosim.org/1.0/a/models/b/3`; correct it, or load the world"}},
    {"duplicate_body", model(shape) + "\n" + model(shape), {"world.sdf:5: another model is called 'm'"}},
    {"nan_pose",
     "<model name=\"m\"><pose>nan 0 0 0 0 0</pose><link name=\"l\"/></model>",
     {"world.sdf:3: ", "finite"}},
    {"unknown_frame",
     "<model name=\"m\"><pose relative_to=\"nobody\">0 0 0 0 0 0</pose><link name=\"l\"/></model>",
     {"world.sdf:3: ", "nobody"}},
    {"nameless", "<model><link name=\"l\"/></model>", {"world.sdf:3: ", "name"}},
    {"unbalanced", "<model name=\"m\">", {"world.sdf:", "not well-formed XML"}},
};

INSTANTIATE_TEST_SUITE_P(Cases, BadWorld, testing::ValuesIn(cases),
                         [](const testing::TestParamInfo<Case>& test) { return test.param.name; });

/// All errors of a world, a line each.
std::vector<std::string> all_errors(const std::filesystem::path& file) {
  try {
    load_world(file, {});
  } catch (const WorldError& error) {
    std::vector<std::string> lines{error.what()};
    lines.insert(lines.end(), error.more.begin(), error.more.end());
    return lines;
  }
  return {};
}

/// A world from somebody else may name any file.
TEST(BadWorldFile, LeadsOutOfItsFolders) {
  const test::TempFolder folder;
  folder.write("secret/quad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("secret/model.sdf", "<sdf version=\"1.9\"><model name=\"s\"/></sdf>");
  folder.write("project/models/b/model.config", "<model><sdf version=\"1.9\">model.sdf</sdf></model>");
  folder.write("project/worlds/a/README", "");
  const auto mesh = [](const std::string& uri) {
    return model("<geometry><mesh><uri>" + uri + "</uri></mesh></geometry>");
  };
  const std::string quad = (folder.path() / "secret/quad.obj").string();
  for (const std::string& content :
       {mesh(quad), mesh("file://" + quad), mesh("../../secret/quad.obj"), mesh("a/../../../secret/quad.obj"),
        mesh("model://b/../../../secret/quad.obj"), mesh("/etc/passwd"), mesh("file:////etc/passwd"),
        std::string("<include><uri>../../secret</uri></include>"),
        std::string("<include><uri>model://../../secret</uri></include>")}) {
    const auto file = folder.write(
        "project/worlds/w.sdf", "<sdf version=\"1.9\">\n<world name=\"w\">\n" + content + "\n</world></sdf>");
    EXPECT_THAT(error_of_world(file), HasSubstr("leads out of the folders of this world and its models"))
        << content;
  }
}

/// A model's manifest names a file too.
TEST(BadWorldFile, LeadsOutOfItsFoldersByAManifest) {
  const test::TempFolder folder;
  folder.write("secret/model.sdf", "<sdf version=\"1.9\"><model name=\"s\"/></sdf>");
  folder.write("project/models/b/model.config",
               "<model><sdf version=\"1.9\">../../../secret/model.sdf</sdf></model>");
  const auto file = folder.write(
      "project/worlds/w.sdf",
      "<sdf version=\"1.9\">\n<world name=\"w\">\n<include><uri>model://b</uri></include>\n</world></sdf>");
  EXPECT_THAT(error_of_world(file), HasSubstr("leads out of the folders of this world and its models"));
}

TEST(BadWorldFile, LeadsOutOfTheCacheOfFuel) {
  const test::TempFolder folder;
  folder.write("secret/quad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("cache/fuel.gazebosim.org/me/models/reef/1/quad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  setenv("GZ_FUEL_CACHE_PATH", (folder.path() / "cache").c_str(), 1);
  const auto world = [&](const std::string& rest) {
    return folder.write("project/worlds/w.sdf",
                        "<sdf version=\"1.9\">\n<world name=\"w\">\n" +
                            model("<geometry><mesh><uri>https://fuel.gazebosim.org/1.0/me/models/" + rest +
                                  "</uri></mesh></geometry>") +
                            "\n</world></sdf>");
  };
  EXPECT_EQ(error_of_world(world("reef/1/files/quad.obj")), "no error");
  for (const char* rest : {"reef/1/files/../../../../../../secret/quad.obj",
                           "reef/1/files/%2e%2e/../../../../../secret/quad.obj",
                           "reef/1/files/..%2F..%2F..%2F..%2F..%2F..%2Fsecret%2Fquad.obj"}) {
    EXPECT_THAT(error_of_world(world(rest)), HasSubstr("sonard downloads nothing")) << rest;
  }
  unsetenv("GZ_FUEL_CACHE_PATH");
}

TEST(WorldFile, MayBeInItsFoldersModelsAndMeshes) {
  const test::TempFolder folder;
  const std::string quad = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const std::string project = (folder.path() / "project").string();
  for (const char* place : {"worlds/here/quad.obj", "meshes/quad.obj", "models/b/quad.obj"}) {
    folder.write("project/" + std::string(place), quad);
  }
  folder.write("elsewhere/quad.obj", quad);
  std::filesystem::create_directory_symlink(folder.path() / "elsewhere",
                                            folder.path() / "project/worlds/link");
  std::filesystem::create_directory_symlink(folder.path() / "project/meshes",
                                            folder.path() / "project/worlds/inner");
  const auto world = [&](const std::string& uri) {
    return folder.write("project/worlds/w.sdf",
                        "<sdf version=\"1.9\">\n<world name=\"w\">\n" +
                            model("<geometry><mesh><uri>" + uri + "</uri></mesh></geometry>") +
                            "\n</world></sdf>");
  };
  for (const std::string& uri :
       {std::string("here/quad.obj"), std::string("here/../here/quad.obj"), std::string("../meshes/quad.obj"),
        std::string("../models/b/quad.obj"), std::string("model://b/quad.obj"),
        project + "/models/b/quad.obj", std::string("inner/quad.obj")}) {
    EXPECT_EQ(error_of_world(world(uri)), "no error") << uri;
  }
  const auto linked = world("link/quad.obj");
  EXPECT_THAT(error_of_world(linked), HasSubstr("leads out of the folders of this world and its models"));
  EXPECT_NO_THROW(load_world(linked, {folder.path() / "elsewhere"})) << "named by the operator";
  const auto outside = world((folder.path() / "elsewhere/quad.obj").string());
  EXPECT_NO_THROW(load_world(outside, {folder.path() / "elsewhere"})) << "named by the operator";
}

TEST(BadWorldFile, IsToldOfWhole) {
  const test::TempFolder folder;
  const auto file = folder.write(
      "w.sdf", "<sdf version=\"1.9\" xmlns:sonard=\"x\"><world name=\"w\">\n" +
                   model(shape + "<sonard:material>conrete</sonard:material>") +
                   "\n<model name=\"n\"><link name=\"l\">" +
                   "\n<visual name=\"a\"><geometry><mesh><uri>gone.obj</uri></mesh></geometry></visual>" +
                   "\n<visual name=\"b\"><geometry><sphere><radius>x</radius></sphere></geometry></visual>" +
                   "\n<visual name=\"c\"><pose>1 2 3</pose>" + shape + "</visual></link></model>" +
                   "\n<include><uri>model://gone</uri></include></world></sdf>");
  EXPECT_THAT(all_errors(file),
              testing::UnorderedElementsAre(HasSubstr("w.sdf:3: m::l::v: unknown material 'conrete'"),
                                            HasSubstr("w.sdf:5: n::l::a: 'gone.obj' not found"),
                                            HasSubstr("w.sdf:6: n::l::b: radius 'x': expected a number"),
                                            HasSubstr("w.sdf:7: pose '1 2 3': expected 6 numbers"),
                                            HasSubstr("w.sdf:8: include 'model://gone' not found")));
}

TEST(BadWorldFile, IsToldOfInBounds) {
  const test::TempFolder folder;
  std::string models;
  for (int i = 0; i < 3000; ++i) {
    models += "<include><uri>model://gone" + std::to_string(i) + "</uri></include>\n";
  }
  const auto lines = all_errors(
      folder.write("w.sdf", "<sdf version=\"1.9\"><world name=\"w\">" + models + "</world></sdf>"));
  ASSERT_EQ(lines.size(), 1001U);
  EXPECT_EQ(lines.back(), "more problems are not shown");
}

TEST(BadWorldFile, IncludesItself) {
  const test::TempFolder folder;
  const auto including = [&](const std::string& name, const std::string& other) {
    return folder.write(name, "<sdf version=\"1.9\"><model name=\"m\"><link name=\"l\"><visual name=\"v\">" +
                                  shape + "</visual></link>\n<include><uri>" + other +
                                  "</uri></include></model></sdf>");
  };
  EXPECT_THAT(all_errors(including("self.sdf", "self.sdf")),
              testing::ElementsAre(
                  HasSubstr("self.sdf:2: include 'self.sdf' includes itself: self.sdf -> self.sdf")));
  including("b.sdf", "a.sdf");
  EXPECT_THAT(
      all_errors(including("a.sdf", "b.sdf")),
      testing::ElementsAre(HasSubstr("b.sdf:2: include 'a.sdf' includes itself: a.sdf -> b.sdf -> a.sdf")));
}

TEST(BadWorldFile, IncludesItselfByWayOfFolders) {
  const test::TempFolder folder;
  for (const auto& [name, other] : {std::pair{"a", "b"}, {"b", "a"}}) {
    folder.write(std::string("models/") + name + "/model.sdf",
                 std::string("<sdf version=\"1.9\"><model name=\"m\"><include><uri>model://") + other +
                     "</uri></include></model></sdf>");
  }
  EXPECT_THAT(
      all_errors(folder.write("w.sdf",
                              "<sdf version=\"1.9\"><world name=\"w\"><include><uri>model://a"
                              "</uri></include></world></sdf>")),
      testing::ElementsAre(HasSubstr("models/a/model.sdf -> models/b/model.sdf -> models/a/model.sdf")));
}

/// 12 includes on each of 9 levels would be five thousand million models.
TEST(BadWorldFile, HasIncludesThatMultiply) {
  const test::TempFolder folder;
  folder.write("m0.sdf", "<sdf version=\"1.9\"><model name=\"m\"><link name=\"l\"/></model></sdf>");
  std::filesystem::path file;
  for (int level = 1; level <= 9; ++level) {
    std::string text = "<sdf version=\"1.9\"><model name=\"m\">";
    for (int i = 0; i < 12; ++i) {
      text += "<include><name>i" + std::to_string(i) + "</name><uri>m" + std::to_string(level - 1) +
              ".sdf</uri></include>";
    }
    file = folder.write("m" + std::to_string(level) + ".sdf", text + "</model></sdf>");
  }
  EXPECT_THAT(error_of_world(file), HasSubstr("m9.sdf: more than 1000000 elements, includes among them"));
}

TEST(BadWorldFile, IsOfAnotherKind) {
  const test::TempFolder folder;
  EXPECT_THAT(error_of_world(folder.write("arm.urdf", "<robot name=\"arm\"/>")),
              HasSubstr("<robot> is not SDF"));
  EXPECT_THAT(error_of_world(folder.write("old.sdf", "<sdf version=\"1.2\"><model name=\"m\"/></sdf>")),
              AllOf(HasSubstr("SDF version 1.2 is too old"), HasSubstr("gz sdf -c")));
}

TEST(BadWorldFile, HasPosesThatAreRelativeToEachOther) {
  const test::TempFolder folder;
  EXPECT_THAT(
      error_of_world(folder.write("w.sdf",
                                  "<sdf version=\"1.9\"><model name=\"m\">"
                                  "<frame name=\"a\"><pose relative_to=\"b\">1 0 0 0 0 0</pose></frame>"
                                  "\n<frame name=\"b\"><pose relative_to=\"a\">1 0 0 0 0 0</pose></frame>"
                                  "<link name=\"l\"><pose relative_to=\"a\"/><visual name=\"v\">" +
                                      shape + "</visual></link></model></sdf>")),
      HasSubstr("is relative to itself, through other frames"));
}

TEST(BadWorldFile, MayNotBeRead) {
  const test::TempFolder folder;
  folder.write("m/model.sdf", "<sdf version=\"1.9\"><model name=\"m\"/></sdf>");
  folder.write("quad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string mesh = "<geometry><mesh><uri>quad.obj</uri></mesh></geometry>";
  const auto world = [&](const std::string& name, const std::string& content) {
    return folder.write(name, "<sdf version=\"1.9\"><world name=\"w\">" + content + "</world></sdf>");
  };
  const auto closed = world("closed.sdf", model(mesh));
  const auto with_mesh = world("mesh.sdf", model(mesh));
  const auto with_include = world("include.sdf", "<include><uri>m</uri></include>");
  using std::filesystem::perms;
  for (const char* const name : {"closed.sdf", "quad.obj", "m/model.sdf"}) {
    std::filesystem::permissions(folder.path() / name, perms::none);
  }
  for (const auto& path : {folder.path(), folder.path() / "m"}) {
    std::filesystem::permissions(path, perms::all);
  }
  const sonard::test::WithoutRights nobody;
  EXPECT_THAT(error_of_world(closed), HasSubstr("closed.sdf: cannot be read: Permission denied"));
  EXPECT_THAT(error_of_world(with_mesh), HasSubstr("quad.obj: cannot be read: Permission denied"));
  EXPECT_THAT(error_of_world(with_include), HasSubstr("m/model.sdf: cannot be read: Permission denied"));
}

TEST(BadWorldFile, IsInAFolderThatMayNotBeRead) {
  const test::TempFolder folder;
  folder.write("m/model.sdf", "<sdf version=\"1.9\"><model name=\"m\"/></sdf>");
  folder.write("parts/quad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("hidden/w.sdf", "<sdf version=\"1.9\"><world name=\"w\"/></sdf>");
  const auto world = [&](const std::string& name, const std::string& content) {
    return folder.write(name, "<sdf version=\"1.9\"><world name=\"w\">" + content + "</world></sdf>");
  };
  const auto with_mesh =
      world("mesh.sdf", model("<geometry><mesh><uri>parts/quad.obj</uri></mesh></geometry>"));
  const auto with_include = world("include.sdf", "<include><uri>model://m</uri></include>");
  using std::filesystem::perms;
  std::filesystem::permissions(folder.path(), perms::all);
  for (const char* const name : {"m", "parts", "hidden"}) {
    std::filesystem::permissions(folder.path() / name, perms::none);
  }
  const std::string why = ": cannot be read: Permission denied";
  const sonard::test::WithoutRights nobody;
  EXPECT_THAT(error_of_world(with_mesh), HasSubstr("parts/quad.obj" + why));
  EXPECT_THAT(error_of_world(with_include), HasSubstr("m/model.config" + why));
  EXPECT_THAT(error_of_world(folder.path() / "hidden/w.sdf"), HasSubstr("hidden/w.sdf" + why));
}

TEST(BadWorldFile, IsALoopOfLinks) {
  const test::TempFolder folder;
  const std::filesystem::path loop = folder.path() / "loop";
  std::filesystem::create_symlink(loop, loop);
  const std::string why = ": cannot be read: Too many levels of symbolic links";
  EXPECT_THAT(error_of_world(loop), HasSubstr("loop" + why));
  EXPECT_THAT(error_of_world(folder.write(
                  "w.sdf",
                  "<sdf version=\"1.9\"><world name=\"w\"><include><uri>loop</uri></include></world></sdf>")),
              HasSubstr("loop" + why));
}

TEST(BadWorldFile, IsNamed) {
  const test::TempFolder folder;
  EXPECT_EQ(error_of_world("/nowhere/w.sdf"), "/nowhere/w.sdf: world file not found");
  EXPECT_THAT(error_of_world(folder.path()), testing::EndsWith(": is a folder (expected an SDF file)"));
  EXPECT_EQ(error_of_world("nowhere/../w.sdf"), "nowhere/../w.sdf: world file not found, looked for " +
                                                    (std::filesystem::current_path() / "w.sdf").string());
  EXPECT_THAT(error_of_world(folder.write("empty.sdf", "")), HasSubstr("empty.sdf:1: not well-formed XML"));
  EXPECT_THAT(error_of_world(folder.write("bare.sdf", "<?xml version=\"1.0\"?>\n")),
              HasSubstr("bare.sdf: has no element"));
  EXPECT_THAT(error_of_world(folder.write(
                  "two.sdf", "<sdf version=\"1.9\"><world name=\"a\"/><world name=\"b\"/></sdf>")),
              AllOf(HasSubstr("two.sdf"), HasSubstr("2 worlds")));
  EXPECT_THAT(error_of_world(folder.write("none.sdf", "<sdf version=\"1.9\"/>")), HasSubstr("none.sdf"));
}

}  // namespace
}  // namespace sonard::render
