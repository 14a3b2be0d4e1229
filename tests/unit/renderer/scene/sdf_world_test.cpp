// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/scene/world.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::filesystem::path shared_worlds = std::filesystem::path(SONARD_SOURCE_DIR) / "tests/data/worlds";

/// One model "m" with one link "l" that holds `visuals`.
std::string world_of(const std::string& visuals) {
  return "<?xml version=\"1.0\"?>\n<sdf version=\"1.9\" xmlns:sonard=\"https://sonard.dev/sdf\">\n<world "
         "name=\"w\">"
         "<model name=\"m\"><link name=\"l\">\n" +
         visuals + "\n</link></model></world></sdf>\n";
}

std::string visual(const std::string& name, const std::string& content) {
  return "<visual name=\"" + name + "\">" + content + "</visual>\n";
}

std::string geometry(const std::string& shape) {
  return "<geometry>" + shape + "</geometry>";
}

const std::string ball = geometry("<sphere><radius>1</radius></sphere>");

void expect_near(const glm::dvec3& actual, const glm::dvec3& expected) {
  EXPECT_NEAR(glm::distance(actual, expected), 0.0, 1e-9) << actual.x << " " << actual.y << " " << actual.z;
}

class Harbour : public testing::Test {
 protected:
  const World world_ = load_world(shared_worlds / "harbour/harbour.sdf", {});
};

TEST_F(Harbour, HasItsBodiesAndItsWaterSurface) {
  EXPECT_EQ(world_.name, "harbour");
  EXPECT_EQ(world_.water_surface_z_m, -0.25);
  std::vector<std::string> names;
  for (const Body& body : world_.bodies) {
    names.push_back(body.name);
  }
  EXPECT_THAT(names, testing::UnorderedElementsAre("crane_1", "quay", "far_buoy"));
  EXPECT_EQ(world_.find_body("crane"), nullptr);
  EXPECT_THAT(world_.warnings, IsEmpty());
}

// The crane stands at (1 2 3), turned 90 degrees to the left; poses inside it are computed by hand.
TEST_F(Harbour, ResolvesPosesOfLinksAndVisuals) {
  const Body& crane = *world_.find_body("crane_1");
  ASSERT_EQ(crane.parts.size(), 4U);
  expect_near(crane.T_world_body.position_m, {1, 2, 3});
  expect_near(crane.T_world_body * glm::dvec3(1, 0, 0), {1, 3, 3});
  // tower 1 0 0, column 0 0 1 above
  expect_near(crane.parts[0].T_body_part.position_m, {1, 0, 1});
  expect_near((crane.T_world_body * crane.parts[0].T_body_part).position_m, {1, 3, 4});
  // arm 0 0 2 above the tower, rolled by 90 degrees: its y is up; the jib is 1 along that
  expect_near(crane.parts[1].T_body_part.position_m, {1, 0, 3});
  expect_near(crane.parts[1].T_body_part * glm::dvec3(0, 0, 1), {1, -1, 3});
  expect_near(crane.T_world_body * (crane.parts[1].T_body_part * glm::dvec3(0, 0, 1)), {2, 3, 6});
}

TEST_F(Harbour, ResolvesPosesOfNestedModels) {
  const Body& crane = *world_.find_body("crane_1");
  // hook 0 0 1, rolled by 90 degrees; its block is 0 1 0 in it, which is up
  expect_near(crane.parts[3].T_body_part.position_m, {0, 0, 2});
  expect_near((crane.T_world_body * crane.parts[3].T_body_part).position_m, {1, 2, 5});
  EXPECT_EQ(crane.parts[3].material.name, "steel");  // from its model
  EXPECT_EQ(crane.parts[0].material.name, "default");
}

TEST_F(Harbour, ResolvesPosesRelativeToFrames) {
  expect_near(world_.find_body("quay")->T_world_body.position_m, {100, 5, 0});
}

TEST_F(Harbour, KeepsLargeCoordinatesInDouble) {
  EXPECT_EQ(world_.find_body("far_buoy")->T_world_body.position_m, glm::dvec3(5000000.25, -4000000.5, -2.0));
}

TEST_F(Harbour, ReadsAMeshOnceAndScalesIt) {
  const Body& crane = *world_.find_body("crane_1");
  EXPECT_EQ(crane.parts[1].mesh, crane.parts[2].mesh);
  EXPECT_EQ(test::bounds(*crane.parts[1].mesh).low.z, -6.0);
  EXPECT_NEAR(test::volume_m3(*crane.parts[1].mesh), 8.0, 1e-5);
}

TEST_F(Harbour, TakesVisualsAndNotCollisions) {
  const Body& quay = *world_.find_body("quay");
  ASSERT_EQ(quay.parts.size(), 1U);
  EXPECT_NEAR(test::area_m2(*quay.parts[0].mesh), 200.0, 1e-3);
  EXPECT_NEAR(glm::distance(quay.parts[0].mesh->normals[0], glm::vec3(1, 0, 0)), 0.0, 1e-6);
}

TEST(SdfWorld, MayBeASingleModel) {
  const World world = load_world(shared_worlds / "harbour/models/hook/model.sdf", {});
  ASSERT_EQ(world.bodies.size(), 1U);
  EXPECT_EQ(world.bodies[0].name, "hook");
  EXPECT_FALSE(world.water_surface_z_m);
}

std::string named_box(const std::string& name) {
  return "<model name=\"" + name +
         "\"><link name=\"l\"><visual name=\"v\"><geometry><box/></geometry></visual></link></model>\n";
}

std::vector<std::string> bodies_of(const World& world) {
  std::vector<std::string> names;
  for (const Body& body : world.bodies) {
    names.push_back(body.name);
  }
  return names;
}

TEST(SdfWorld, NamesModelsBesideTheWorldOrModelThatItLoads) {
  const test::TempFolder folder;
  folder.write("models/b/model.sdf", "<sdf version=\"1.9\">" + named_box("b") + "</sdf>");
  const auto load = [&](const std::string& content) {
    return load_world(folder.write("w.sdf", "<sdf version=\"1.9\">\n" + content + "</sdf>"), {});
  };
  const std::string beside = "model 'b' is left out, because it is outside of <world>; move it into <world>";
  const std::string second = "model 'b' is left out, because a file without <world> has one model; ";
  const World with_world = load("<world name=\"w\">\n" + named_box("a") + "</world>\n" + named_box("b"));
  EXPECT_THAT(bodies_of(with_world), ElementsAre("a"));
  EXPECT_THAT(with_world.warnings, ElementsAre(HasSubstr("w.sdf:5: " + beside)));
  const World reversed = load(named_box("b") + "<world name=\"w\">\n" + named_box("a") + "</world>\n");
  EXPECT_THAT(bodies_of(reversed), ElementsAre("a"));
  EXPECT_THAT(reversed.warnings, ElementsAre(HasSubstr("w.sdf:2: " + beside)));
  const World of_models = load(named_box("a") + named_box("b"));
  EXPECT_THAT(bodies_of(of_models), ElementsAre("a"));
  EXPECT_THAT(of_models.warnings, ElementsAre(HasSubstr("w.sdf:3: " + second)));
  const World of_includes = load(named_box("a") + "<include><uri>b</uri></include>");
  EXPECT_THAT(of_includes.warnings, ElementsAre(HasSubstr("models/b/model.sdf:1: " + second)));
}

// libsdformat, too, takes a model before anything else.
TEST(SdfWorld, NamesModelsBesideTheIncludedOne) {
  const test::TempFolder folder;
  folder.write("two.sdf",
               "<sdf version=\"1.9\">\n<light name=\"lamp\" type=\"point\"/>\n<actor name=\"diver\"/>\n" +
                   named_box("c") + named_box("d") + "</sdf>");
  const World world =
      load_world(folder.write("w.sdf",
                              "<sdf version=\"1.9\"><world name=\"w\"><include><uri>two.sdf</uri></include>"
                              "<include><name>e</name><uri>two.sdf</uri></include></world></sdf>"),
                 {});
  EXPECT_THAT(bodies_of(world), ElementsAre("c", "e"));
  const std::string why =
      " is left out, because an include takes one model from a file; move it to its own file";
  EXPECT_THAT(world.warnings, ElementsAre(HasSubstr("two.sdf:3: actor 'diver'" + why),
                                          HasSubstr("two.sdf:5: model 'd'" + why)));
}

TEST(SdfWorld, FindsModelsInTheGivenFolders) {
  const test::TempFolder folder;
  const auto file = folder.write(
      "w.sdf",
      "<sdf version=\"1.9\"><world name=\"w\"><include><uri>model://hook</uri></include></world></sdf>");
  EXPECT_THROW(load_world(file, {}), WorldError);
  EXPECT_NE(load_world(file, {shared_worlds / "harbour/models"}).find_body("hook"), nullptr);
}

TEST(SdfWorld, IsNotMisledByTheWorkingDirectory) {
  const std::string model = "<sdf version=\"1.9\"><model name=\"m\"><link name=\"l\"><visual name=\"v\">";
  const test::TempFolder folder;
  folder.write("decoy/models/rock/model.sdf", model + ball + "</visual></link></model></sdf>");
  folder.write("world/models/rock/model.sdf",
               model + geometry("<box><size>1 1 1</size></box>") + "</visual></link></model></sdf>");
  const auto file = folder.write("world/w.sdf",
                                 "<sdf version=\"1.9\"><world name=\"w\">\n<include>"
                                 "<uri>models/rock/model.sdf</uri></include></world></sdf>");
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path() / "decoy");
  const World world = load_world(file, {});
  std::filesystem::current_path(before);
  EXPECT_EQ(world.triangle_count(), 12U);
}

TEST(SdfWorld, TakesTheNewestFileOfAManifest) {
  const test::TempFolder folder;
  folder.write("models/rock/model.config",
               "<model><name>rock</name><sdf version=\"1.9\">old.sdf</sdf><sdf "
               "version=\"1.10\">new.sdf</sdf></model>");
  const auto model = [](const std::string& shape) {
    return "<sdf version=\"1.9\"><model name=\"m\"><link name=\"l\"><visual name=\"v\">" + shape +
           "</visual></link></model></sdf>";
  };
  folder.write("models/rock/old.sdf", model(ball));
  folder.write("models/rock/new.sdf", model(geometry("<box><size>1 1 1</size></box>")));
  EXPECT_EQ(load_world(folder.write("w.sdf",
                                    "<sdf version=\"1.9\"><world "
                                    "name=\"w\"><include><uri>model://rock</uri></include></world></sdf>"),
                       {})
                .triangle_count(),
            12U);
}

/// Versions 1.10 to 1.12 are read alike, without their elements that have no echo.
TEST(SdfWorld, ReadsNewVersions) {
  for (const char* version : {"1.10", "1.11", "1.12"}) {
    const test::TempFolder folder;
    const World world = load_world(
        folder.write(
            "w.sdf",
            std::string("<sdf version=\"") + version +
                "\"><world name=\"w\"><model name=\"m\" params=\"\">"
                "<link name=\"l\" gravity=\"0\"><inertial auto=\"true\"><density>100</density></inertial>" +
                visual("v", ball) + "<sensor name=\"s\" type=\"dvl\"/></link></model></world></sdf>"),
        {});
    EXPECT_THAT(world.warnings, IsEmpty()) << version;
    EXPECT_THAT(world.left_out, ElementsAre("sensors of other kinds (1): m::l::s (dvl)"));
  }
  const test::TempFolder folder;
  const World newer =
      load_world(folder.write("w.sdf", "<sdf version=\"1.13\"><model name=\"m\"><link name=\"l\">" +
                                           visual("v", ball) + "</link></model></sdf>"),
                 {});
  EXPECT_THAT(newer.warnings, ElementsAre(HasSubstr("w.sdf:1: SDF version 1.13 is read as 1.12")));
}

// A quarter turn to port three times: as angles, in degrees, as a quaternion.
TEST(SdfWorld, ReadsPosesInEachForm) {
  for (const char* pose :
       {"<pose>1 2 3 0 0 1.5707963267948966</pose>", "<pose degrees=\"true\">1 2 3 0 0 90</pose>",
        "<pose degrees=\"True\">1 2 3 0 0 90</pose>",
        "<pose rotation_format=\"quat_xyzw\">1 2 3  0 0 0.7071067811865476 0.7071067811865476</pose>"}) {
    const test::TempFolder folder;
    const World world = load_world(
        folder.write("w.sdf", std::string("<sdf version=\"1.10\"><world name=\"w\"><model name=\"m\">") +
                                  pose + "<link name=\"l\">" + visual("v", ball) +
                                  "</link></model></world></sdf>"),
        {});
    expect_near(world.bodies.at(0).T_world_body * glm::dvec3(1, 0, 0), {1, 3, 3});
  }
}

// An arm's parts become the vehicle's: the arm sits 1 m ahead and 2 m up, its wrist 0.5 m further out.
TEST(SdfWorld, MergesWhatIsIncludedSo) {
  const test::TempFolder folder;
  folder.write(
      "arm.sdf",
      "<sdf version=\"1.9\" xmlns:sonard=\"x\"><model name=\"arm\"><sonard:material>steel</sonard:material>"
      "<link name=\"upper\">" +
          visual("v", ball) +
          "</link><frame name=\"end\" attached_to=\"upper\"><pose>0.5 0 0 0 0 0</pose></frame>"
          "<link name=\"wrist\"><pose relative_to=\"end\"/>" +
          visual("v", ball) + "</link></model></sdf>");
  const World world = load_world(
      folder.write("w.sdf",
                   "<sdf version=\"1.9\"><world name=\"w\"><model name=\"rov\"><link name=\"hull\">" +
                       visual("v", ball) +
                       "</link><include merge=\"true\"><uri>arm.sdf</uri><pose relative_to=\"hull\">1 0 2 0 "
                       "0 0</pose></include></model></world></sdf>"),
      {});
  const auto& parts = world.bodies.at(0).parts;
  ASSERT_EQ(parts.size(), 3U);
  expect_near(parts[1].T_body_part.position_m, {1, 0, 2});
  expect_near(parts[2].T_body_part.position_m, {1.5, 0, 2});
  EXPECT_EQ(parts[0].material.name, "default");
  EXPECT_EQ(parts[2].material.name, "steel");
}

/// The pose of an include is the pose of the frame that it names, even if the model is merged.
TEST(SdfWorld, MergesByAPlacementFrame) {
  const test::TempFolder folder;
  folder.write("crane.sdf", "<sdf version=\"1.9\"><model name=\"crane\"><link name=\"l\">" +
                                visual("v", ball) +
                                "</link><link name=\"tip\"><pose>2 0 1 0 0 1.5707963267948966</pose>" +
                                visual("v", ball) + "</link></model></sdf>");
  const World world = load_world(
      folder.write("w.sdf",
                   "<sdf version=\"1.10\"><world name=\"w\"><model name=\"m\"><pose>0 0 20 0 0 0</pose>"
                   "<include merge=\"true\"><uri>crane.sdf</uri><placement_frame>tip</placement_frame>"
                   "<pose>1 0 0 0 0 0</pose></include></model></world></sdf>"),
      {});
  const Body& body = world.bodies.at(0);
  ASSERT_EQ(body.parts.size(), 2U);
  expect_near(body.parts[0].T_body_part.position_m, {1, 2, -1});
  expect_near(body.parts[1].T_body_part.position_m, {1, 0, 0});
  EXPECT_THAT(world.warnings, IsEmpty());
}

TEST(SdfWorld, TakesTheManifestOfOldModels) {
  const test::TempFolder folder;
  folder.write("post/manifest.xml", "<model><name>post</name><sdf version=\"1.4\">old.sdf</sdf></model>");
  folder.write("post/old.sdf", "<sdf version=\"1.4\"><model name=\"post\"><link name=\"l\">" +
                                   visual("v", ball) + "</link></model></sdf>");
  const World world =
      load_world(folder.write("w.sdf",
                              "<sdf version=\"1.9\"><world name=\"w\"><include><uri>model://post"
                              "</uri></include></world></sdf>"),
                 {});
  EXPECT_EQ(world.bodies.at(0).parts.size(), 1U);
  EXPECT_THAT(world.warnings,
              ElementsAre(HasSubstr("post: manifest.xml is out of date; rename it to model.config")));
}

// As `gz fuel download` leaves it: owner and name in lower case, a folder for each version.
TEST(SdfWorld, FindsModelsOfFuelInTheLocalCache) {
  const test::TempFolder folder;
  const auto model = [](const std::string& shape) {
    return "<sdf version=\"1.7\"><model name=\"rock\"><link name=\"l\"><visual name=\"v\">" + shape +
           "</visual></link></model></sdf>";
  };
  const std::string cache = "cache/fuel.gazebosim.org/openrobotics/models/big rock/";
  folder.write(cache + "9/model.sdf", model(ball));
  folder.write(cache + "10/meshes/rock.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write(cache + "10/model.sdf",
               model(geometry("<mesh><uri>model://Big Rock/meshes/rock.obj</uri></mesh>")));
  setenv("GZ_FUEL_CACHE_PATH", (folder.path() / "cache").c_str(), 1);
  const auto triangles = [&](const std::string& uri) {
    return load_world(folder.write("w.sdf", "<sdf version=\"1.9\"><world name=\"w\"><include><uri>" + uri +
                                                "</uri></include></world></sdf>"),
                      {})
        .triangle_count();
  };
  EXPECT_EQ(triangles("https://fuel.gazebosim.org/1.0/OpenRobotics/models/Big%20Rock"), 1U)
      << "the newest, and its own mesh";
  EXPECT_EQ(triangles("https://fuel.ignitionrobotics.org/1.0/openrobotics/models/Big Rock/tip"), 1U);
  EXPECT_GT(triangles("fuel://fuel.gazebosim.org/OpenRobotics/models/Big%20Rock/9/files/model.sdf"), 1U);
  EXPECT_THROW(triangles("https://fuel.gazebosim.org/1.0/OpenRobotics/models/Big%20Rock/3"), WorldError);
  unsetenv("GZ_FUEL_CACHE_PATH");
}

TEST(SdfWorld, GoesOnWithoutWhatIsMissingIfItMay) {
  const test::TempFolder folder;
  const auto file = folder.write(
      "w.sdf",
      world_of(visual("v", ball) + visual("gone", geometry("<mesh><uri>gone.obj</uri></mesh>"))) + "");
  EXPECT_THROW(load_world(file, {}), WorldError);
  const World world = load_world(file, {}, MissingFiles::skip);
  EXPECT_EQ(world.bodies.at(0).parts.size(), 1U);
  EXPECT_THAT(world.warnings,
              ElementsAre(testing::AllOf(HasSubstr("shapes are left out: 'gone.obj' not found"),
                                         HasSubstr("(1): m::l::gone"))));
  const auto including = folder.write("i.sdf",
                                      "<sdf version=\"1.9\"><world "
                                      "name=\"w\"><include><uri>w.sdf</uri></include><include><uri>model://"
                                      "gone</uri></include></world></sdf>");
  EXPECT_THAT(load_world(including, {}, MissingFiles::skip).warnings,
              testing::Contains(HasSubstr("i.sdf:1: include 'model://gone' not found")));
}

TEST(SdfWorld, TakesTheMaterialOfAnInclude) {
  const test::TempFolder folder;
  folder.write("rock.sdf", "<sdf version=\"1.9\"><model name=\"rock\"><link name=\"l\">" + visual("v", ball) +
                               "</link></model></sdf>");
  const World world = load_world(folder.write("w.sdf",
                                              "<sdf version=\"1.9\" xmlns:sonard=\"x\"><world "
                                              "name=\"w\"><include><uri>rock.sdf</uri><sonard:material>mud</"
                                              "sonard:material></include></world></sdf>"),
                                 {});
  EXPECT_EQ(world.bodies.at(0).parts.at(0).material.name, "mud");
}

/// Equal bodies share their triangles, so that many take little memory.
TEST(SdfWorld, HoldsTenThousandModels) {
  std::string models;
  for (int i = 0; i < 10'000; ++i) {
    models += "<model name=\"m" + std::to_string(i) + "\"><pose>" + std::to_string(i) +
              " 0 0 0 0 0</pose><link name=\"l\">" + visual("v", ball) + "</link></model>\n";
  }
  const test::TempFolder folder;
  const World world =
      load_world(folder.write("w.sdf", "<sdf version=\"1.9\"><world name=\"w\">" + models + "</world></sdf>"),
                 {}, MissingFiles::error, std::nullopt, 100'000'000);
  ASSERT_EQ(world.bodies.size(), 10'000U);
  EXPECT_EQ(world.bodies.front().parts.at(0).mesh, world.bodies.back().parts.at(0).mesh);
  expect_near(world.bodies.back().T_world_body.position_m, {9999, 0, 0});
}

std::string error_with_limit(const std::string& world, std::size_t max_triangles) {
  const test::TempFolder folder;
  folder.write("tetrahedron.stl", std::string());
  std::filesystem::copy_file(shared_worlds / "tetrahedron.stl", folder.path() / "tetrahedron.stl",
                             std::filesystem::copy_options::overwrite_existing);
  try {
    load_world(folder.write("w.sdf", world), {}, MissingFiles::error, std::nullopt, max_triangles);
  } catch (const WorldError& error) {
    return error.what();
  }
  return "";
}

TEST(SdfWorld, HasNoMoreTrianglesThanItMay) {
  const std::string box = geometry("<box><size>1 2 3</size></box>");
  const std::string mesh = geometry("<mesh><uri>tetrahedron.stl</uri></mesh>");
  const std::string boxes = world_of(visual("a", box) + visual("b", box));
  const std::string meshes = world_of(visual("a", mesh) + visual("b", mesh));
  EXPECT_EQ(error_with_limit(boxes, 24), "");
  EXPECT_THAT(error_with_limit(boxes, 23), HasSubstr("w.sdf: the world has more than 23 triangles"));
  EXPECT_EQ(error_with_limit(meshes, 8), "");
  EXPECT_THAT(error_with_limit(meshes, 7), HasSubstr("w.sdf: the world has more than 7 triangles"));
}

// 3,000 different spheres of 260,608 triangles each would take minutes to make.
TEST(SdfWorld, CountsTheTrianglesOfShapesBeforeItMakesThem) {
  std::string spheres;
  for (int i = 0; i < 3000; ++i) {
    spheres += visual("v" + std::to_string(i),
                      geometry("<sphere><radius>" + std::to_string(50.0 + 0.001 * i) + "</radius></sphere>"));
  }
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(error_with_limit(world_of(spheres), default_max_triangles),
              HasSubstr("the world has more than 50000000 triangles"));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

TEST(SdfWorld, KnowsEveryShape) {
  const test::TempFolder folder;
  const auto file = folder.write(
      "w.sdf",
      world_of(visual("a", geometry("<box><size>1 2 3</size></box>")) + visual("b", ball) +
               visual("c", geometry("<cylinder><radius>1</radius><length>2</length></cylinder>")) +
               visual("d", geometry("<capsule><radius>1</radius><length>2</length></capsule>")) +
               visual("e", geometry("<ellipsoid><radii>1 2 3</radii></ellipsoid>")) +
               visual("f", geometry("<plane><normal>0 0 1</normal><size>2 3</size></plane>")) +
               visual("g", geometry("<heightmap><uri>" + (shared_worlds / "grey16.png").string() +
                                    "</uri><size>4 2 8</size><pos>0 0 -5</pos></heightmap>")) +
               visual("h", geometry("<mesh><uri>file://" + (shared_worlds / "tetrahedron.ply").string() +
                                    "</uri></mesh>")) +
               visual("i", geometry("<empty/>"))));
  const World world = load_world(file, {shared_worlds});
  const auto& parts = world.bodies.at(0).parts;
  ASSERT_EQ(parts.size(), 8U);
  const double pi = 3.14159265358979;
  const double expected_volume[] = {6.0, 4.0 / 3.0 * pi, 2.0 * pi, 2.0 * pi + 4.0 / 3.0 * pi, 8.0 * pi};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(test::volume_m3(*parts[i].mesh), expected_volume[i], 0.01 * expected_volume[i]) << i;
  }
  EXPECT_NEAR(test::area_m2(*parts[5].mesh), 6.0, 1e-5);
  EXPECT_EQ(test::bounds(*parts[6].mesh).high, glm::dvec3(2.0, 1.0, 8.0));  // 40000, the brightest, is 8 m up
  EXPECT_EQ(parts[6].T_body_part.position_m, glm::dvec3(0.0, 0.0, -5.0));
  EXPECT_NEAR(test::volume_m3(*parts[7].mesh), 1.0, 1e-6);
}

TEST(SdfWorld, TakesMaterialsInTheDocumentedOrder) {
  const test::TempFolder folder;
  const std::string obj =
      geometry("<mesh><uri>" + (shared_worlds / "tetrahedron.obj").string() + "</uri></mesh>");
  const auto file = folder.write(
      "w.sdf",
      world_of(
          visual("own", ball + "<laser_retro>0.7</laser_retro><sonard:material> mud </sonard:material>") +
          visual("changed", ball + "<sonard:material reflectance=\"1.40\">concrete</sonard:material>") +
          visual("retro", ball + "<laser_retro>0.7</laser_retro>") + visual("none", ball) +
          visual("mesh", obj + "<laser_retro>0.7</laser_retro>") +
          visual("mesh_own", obj + "<sonard:material>pvc</sonard:material>")));
  const World world = load_world(file, {shared_worlds});
  std::vector<std::string> names;
  for (const BodyPart& part : world.bodies.at(0).parts) {
    names.push_back(part.material.name);
  }
  // The OBJ has parts "Rock.001" and "steel".
  EXPECT_THAT(names, ElementsAre("mud", "concrete", "laser_retro", "default", testing::AnyOf("rock", "steel"),
                                 testing::AnyOf("rock", "steel"), "pvc", "pvc"));
  EXPECT_NE(names[4], names[5]);
  EXPECT_EQ(world.bodies[0].parts[1].material.reflectance, 1.4);
  EXPECT_EQ(world.bodies[0].parts[2].material.reflectance, 0.7);
}

TEST(SdfWorld, HandsMaterialsDownFromLinkAndModel) {
  const test::TempFolder folder;
  const auto file =
      folder.write("w.sdf",
                   "<sdf version=\"1.9\" xmlns:sonard=\"x\"><world name=\"w\"><model name=\"m\">"
                   "<sonard:material>wood</sonard:material>"
                   "<link name=\"a\"><sonard:material>rubber</sonard:material>" +
                       visual("v", ball + "<laser_retro>1</laser_retro>") + "</link><link name=\"b\">" +
                       visual("v", ball) + "</link></model></world></sdf>");
  const World world = load_world(file, {});
  EXPECT_EQ(world.bodies.at(0).parts.at(0).material.name, "rubber");
  EXPECT_EQ(world.bodies.at(0).parts.at(1).material.name, "wood");
}

TEST(SdfWorld, SaysWhenAMeshMaterialIsNotAcoustic) {
  const test::TempFolder folder;
  folder.write("paint.mtl", "newmtl RedPaint\nKd 1 0 0\n");
  folder.write("hull.obj", "mtllib paint.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl RedPaint\nf 1 2 3\n");
  const World world = load_world(
      folder.write("w.sdf", world_of(visual("v", geometry("<mesh><uri>hull.obj</uri></mesh>")))), {});
  ASSERT_EQ(world.warnings.size(), 1U);
  EXPECT_THAT(world.warnings[0],
              testing::AllOf(HasSubstr("w.sdf:4"), HasSubstr("m::l::v"), HasSubstr("RedPaint")));
}

TEST(SdfWorld, FallsBackToCollisionsOfAModelWithoutVisuals) {
  const test::TempFolder folder;
  const auto file =
      folder.write("w.sdf", world_of("<collision name=\"c\"><pose>0 0 2 0 0 0</pose>" +
                                     geometry("<box><size>1 1 1</size></box>") +
                                     "<sonard:material>concrete</sonard:material></collision>"));
  const World world = load_world(file, {});
  ASSERT_EQ(world.bodies.at(0).parts.size(), 1U);
  EXPECT_EQ(world.bodies[0].parts[0].material.name, "concrete");
  expect_near(world.bodies[0].parts[0].T_body_part.position_m, {0, 0, 2});
  ASSERT_EQ(world.warnings.size(), 1U);
  EXPECT_THAT(world.warnings[0], HasSubstr("collision shapes"));
}

TEST(SdfWorld, NamesTheMeshesWhoseUpAxisIsNotApplied) {
  const test::TempFolder folder;
  std::ifstream in(shared_worlds / "millimetres.dae");
  std::string text(std::istreambuf_iterator<char>(in), {});
  folder.write("upright.dae", text);
  text.replace(text.find("Z_UP"), 4, "Y_UP");
  folder.write("buoy.dae", text);
  folder.write("anchor.dae", text);
  const auto mesh = [](const std::string& file) {
    return visual(file, geometry("<mesh><uri>" + file + "</uri></mesh>"));
  };
  const World world = load_world(
      folder.write("w.sdf", world_of(mesh("upright.dae") + mesh("buoy.dae") + mesh("anchor.dae"))), {});
  EXPECT_THAT(world.warnings, testing::ElementsAre(testing::EndsWith(
                                  "w.sdf: <up_axis> Y_UP is not applied, as in Gazebo, to anchor.dae, "
                                  "buoy.dae; if such a mesh lies on "
                                  "its side, turn it by <pose>0 0 0 1.5708 0 0</pose> in its <visual>")));
  for (const BodyPart& part : world.bodies.at(0).parts) {
    EXPECT_NEAR(glm::distance(test::bounds(*part.mesh).high, glm::dvec3(1.0, 2.0, 3.5)), 0.0, 1e-5);
  }
}

// Like Gazebo, sonard keeps a shape if it cannot use its map.
TEST(SdfWorld, LeavesANormalMapOutThatItCannotUse) {
  const test::TempFolder folder;
  std::filesystem::copy_file(shared_worlds / "normal_map.png", folder.path() / "ripples.png");
  std::filesystem::copy_file(shared_worlds / "grey8.png", folder.path() / "grey.png");
  folder.write("bad.png", "no picture");
  folder.write("ripples.webp", "a format that is not read");
  folder.write("bare.obj", "v 5 0 0\nv 5 1 0\nv 5 0 1\nf 1 2 3\n");
  const auto with_map = [](const std::string& shape, const std::string& map, const std::string& type = "") {
    return visual("v", shape + "<material><pbr><metal><normal_map" + type + ">" + map +
                           "</normal_map></metal></pbr></material>");
  };
  const std::string grey_map = geometry("<heightmap><uri>grey.png</uri><size>10 10 1</size></heightmap>");
  struct Case {
    std::string visual;
    std::string warning;
  };
  for (const Case& given : {
           Case{with_map(ball, "gone.png"), "the normal map is left out: 'gone.png' not found"},
           Case{with_map(grey_map, "gone.png"), "the normal map is left out: 'gone.png' not found"},
           Case{with_map(ball, "model://gone/a.png"), "the normal map is left out: "},
           Case{with_map(ball, "http://127.0.0.1/a.png"), "the normal map is left out: "},
           Case{with_map(ball, "bad.png"), "bad.png: "},
           Case{with_map(ball, "ripples.webp"), "ripples.webp: 'webp' is not a supported image format"},
           Case{with_map(ball, "grey.png"), "grey.png: a normal map needs 3 channels, this image has 1"},
           Case{with_map(ball, "ripples.png", " type=\"object\""),
                "object-space normal maps are not supported"},
           Case{
               visual("v", ball + "<material><shader type=\"normal_map_object_space\"><normal_map>ripples.png"
                                  "</normal_map></shader></material>"),
               "object-space normal maps are not supported"},
           Case{with_map(geometry("<mesh><uri>bare.obj</uri></mesh>"), "ripples.png"),
                "bare.obj: the normal map is left out on parts without texture coordinates"},
       }) {
    const World world = load_world(folder.write("w.sdf", world_of(given.visual)), {});
    ASSERT_EQ(world.bodies.at(0).parts.size(), 1U) << given.warning;
    EXPECT_EQ(world.bodies[0].parts[0].normal_map, nullptr) << given.warning;
    EXPECT_THAT(world.warnings, testing::ElementsAre(HasSubstr(given.warning)));
  }
}

TEST(SdfWorld, NamesAMissingNormalMapOnce) {
  const test::TempFolder folder;
  std::string visuals;
  for (int i = 0; i < 12; ++i) {
    visuals +=
        visual("v" + std::to_string(i),
               ball + "<material><pbr><metal><normal_map>gone.png</normal_map></metal></pbr></material>");
  }
  EXPECT_THAT(
      load_world(folder.write("w.sdf", world_of(visuals)), {}).warnings,
      ElementsAre(testing::AllOf(HasSubstr("w.sdf:4: the normal map is left out: 'gone.png' not found"),
                                 HasSubstr("(12): m::l::v0"), testing::Not(HasSubstr("missing: skip")))));
}

TEST(SdfWorld, NamesAMissingModelOnce) {
  const test::TempFolder folder;
  std::string includes;
  for (int i = 0; i < 9; ++i) {
    includes += "<include><uri>model://gone</uri><name>b" + std::to_string(i) + "</name></include>\n";
  }
  const World world = load_world(
      folder.write("w.sdf", "<sdf version=\"1.9\"><world name=\"w\">\n" + includes + "</world></sdf>"), {},
      MissingFiles::skip);
  EXPECT_THAT(world.warnings,
              ElementsAre(testing::AllOf(HasSubstr("w.sdf:2: include 'model://gone' not found"),
                                         HasSubstr("(9): b0, b1"))));
}

TEST(SdfWorld, TakesADefaultSubmeshForTheWholeMesh) {
  const test::TempFolder folder;
  folder.write("two.obj", "o a\nv 5 0 0\nv 5 1 0\nv 5 0 1\nf 1 2 3\no b\nf 1 3 2\n");
  const World world = load_world(
      folder.write("w.sdf", world_of(visual("v", geometry("<mesh><uri>two.obj</uri><submesh><name>__default__"
                                                          "</name><center>1</center></submesh></mesh>")))),
      {});
  EXPECT_EQ(world.triangle_count(), 2U);
  EXPECT_EQ(test::bounds(*world.bodies.at(0).parts.at(0).mesh).low.x, 5.0) << "only a submesh is centred";
}

TEST(SdfWorld, LoadsNormalMapsOfBothKindsOnce) {
  const test::TempFolder folder;
  std::filesystem::copy_file(shared_worlds / "normal_map.png", folder.path() / "ripples.png");
  const auto file = folder.write(
      "w.sdf",
      world_of(
          visual("shader", ball +
                               "<material><shader type=\"normal_map_tangent_space\"><normal_map>ripples.png"
                               "</normal_map></shader></material>") +
          visual("pbr",
                 geometry("<plane><normal>0 0 1</normal><size>2 3</size></plane>") +
                     "<material><pbr><metal><normal_map>ripples.png</normal_map></metal></pbr></material>") +
          visual("smooth", ball)));
  const World world = load_world(file, {});
  const auto& parts = world.bodies.at(0).parts;
  ASSERT_NE(parts[0].normal_map, nullptr);
  EXPECT_EQ(parts[0].normal_map->width_px, 2);
  EXPECT_EQ(parts[0].normal_map, parts[1].normal_map);
  EXPECT_EQ(parts[2].normal_map, nullptr);
  EXPECT_TRUE(parts[2].mesh->tangents.empty());
  // u grows along x on a plane, eastward on a sphere: the tangent is horizontal and across the normal.
  for (const glm::vec4& tangent : parts[1].mesh->tangents) {
    EXPECT_NEAR(glm::distance(tangent, glm::vec4(1, 0, 0, 1)), 0.0, 1e-6);
  }
  const TriangleMesh& sphere = *parts[0].mesh;
  for (std::size_t i = 0; i < sphere.positions.size(); ++i) {
    const glm::vec3 east(-sphere.positions[i].y, sphere.positions[i].x, 0.0F);
    if (glm::length(east) > 0.3F) {
      ASSERT_NEAR(glm::dot(glm::vec3(sphere.tangents[i]), glm::normalize(east)), 1.0, 0.01);
    }
  }
}

TEST(SdfWorld, WarnsOfUnknownElements) {
  const test::TempFolder folder;
  const World world =
      load_world(folder.write("w.sdf", world_of(visual("v", ball + "<colour>red</colour>"))), {});
  ASSERT_EQ(world.warnings.size(), 1U);
  EXPECT_THAT(world.warnings[0], HasSubstr("colour"));
}

TEST(SdfWorld, PrintsNothing) {
  const test::TempFolder folder;
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  load_world(folder.write("w.sdf", world_of(visual("v", ball + "<colour>red</colour>"))), {});
  EXPECT_THROW(load_world(folder.write("x.sdf", "<sdf><world"), {}), WorldError);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(SdfWorld, ReadsOldVersions) {
  const test::TempFolder folder;
  const World world = load_world(
      folder.write("w.sdf",
                   "<sdf version=\"1.4\"><world name=\"w\"><model name=\"m\"><pose>1 2 3 0 0 0</pose>"
                   "<link name=\"l\">" +
                       visual("v", ball) + "</link></model></world></sdf>"),
      {});
  expect_near(world.bodies.at(0).T_world_body.position_m, {1, 2, 3});
}

}  // namespace
}  // namespace sonard::render
