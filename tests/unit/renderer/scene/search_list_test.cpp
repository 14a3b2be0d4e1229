// SPDX-License-Identifier: Apache-2.0
// Every URI that Gazebo resolves is resolved: bare names, file:// with a relative path, model://, package://,
// in the folders of the environment. Each test writes its folders. Each model has its own number of
// triangles, so that a wrong one is found: a box has 12, a triangle seen from both sides 2.
#include <cstdlib>
#include <filesystem>
#include <string>

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
using testing::Not;

const std::string triangle_as_obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

class SearchList : public testing::Test {
 protected:
  SearchList() {
    for (const char* variable :
         {"GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "GAZEBO_RESOURCE_PATH",
          "SDF_PATH", "GZ_FILE_PATH", "IGN_FILE_PATH", "GZ_FUEL_CACHE_PATH", "IGN_FUEL_CACHE_PATH"}) {
      unsetenv(variable);
    }
    const char* home = std::getenv("HOME");
    home_ = home == nullptr ? "" : home;
    setenv("HOME", folder_.path().c_str(), 1);
    boxed("lib/post");
  }
  ~SearchList() override {
    setenv("HOME", home_.c_str(), 1);
    for (const std::string& variable : set_) {
      unsetenv(variable.c_str());
    }
  }

  void boxed(const std::string& place) const {
    folder_.write(place + "/model.config", "<model><sdf version=\"1.6\">model.sdf</sdf></model>");
    folder_.write(
        place + "/model.sdf",
        "<sdf version=\"1.6\"><model name=\"post\"><link name=\"l\"><visual name=\"v\"><geometry><box>"
        "<size>1 1 1</size></box></geometry></visual></link></model></sdf>");
    folder_.write(place + "/meshes/a.obj", triangle_as_obj);
  }

  void environment(const std::string& variable, const std::string& folder) {
    setenv(variable.c_str(), (folder_.path() / folder).c_str(), 1);
    set_.push_back(variable);
  }

  /// Loads a world in the folder "project/worlds".
  World load(const std::string& content, MissingFiles missing = MissingFiles::error) const {
    const auto file = folder_.write(
        "project/worlds/w.sdf", "<sdf version=\"1.9\">\n<world name=\"w\">\n" + content + "\n</world></sdf>");
    return load_world(file, model_folders_from_environment(), missing);
  }

  std::string error_of(const std::string& content) const {
    try {
      load(content);
    } catch (const WorldError& error) {
      return error.what();
    }
    return "no error";
  }

  static std::string include(const std::string& uri) { return "<include><uri>" + uri + "</uri></include>"; }
  static std::string mesh(const std::string& uri) {
    return "<model name=\"m\"><link name=\"l\"><visual name=\"v\"><geometry><mesh><uri>" + uri +
           "</uri></mesh></geometry></visual></link></model>";
  }

  test::TempFolder folder_;

 private:
  std::string home_;
  std::vector<std::string> set_;
};

TEST_F(SearchList, HoldsTheFoldersOfEachVariable) {
  for (const char* variable : {"GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH",
                               "GAZEBO_RESOURCE_PATH", "SDF_PATH", "GZ_FILE_PATH", "IGN_FILE_PATH"}) {
    environment(variable, "lib");
    for (const char* uri : {"post", "file://post", "model://post", "package://post", "post/model.sdf",
                            "file://post/model.sdf", "model:///post", "model:////post/model.sdf"}) {
      EXPECT_EQ(load(include(uri)).triangle_count(), 12U) << variable << " " << uri;
    }
    for (const char* uri : {"post/meshes/a.obj", "file://post/meshes/a.obj", "model://post/meshes/a.obj",
                            "model:///post//meshes/a.obj"}) {
      EXPECT_EQ(load(mesh(uri)).triangle_count(), 1U) << variable << " " << uri;
    }
    unsetenv(variable);
    EXPECT_THROW(load(include("post")), WorldError) << variable;
  }
}

TEST_F(SearchList, HoldsWhatGazeboClassicHasDownloaded) {
  boxed(".gazebo/models/buoy");
  EXPECT_EQ(load(include("model://buoy")).triangle_count(), 12U);
  EXPECT_EQ(load(include("buoy")).triangle_count(), 12U);
}

// uuv_simulator uses the first form, with its folder in GAZEBO_RESOURCE_PATH; Gazebo's own files use the
// others.
TEST_F(SearchList, HoldsTheMediaOfResources) {
  folder_.write("share/uuv/Media/models/bed.obj", triangle_as_obj);
  folder_.write("share/gazebo/media/meshes/rock.obj", triangle_as_obj);
  setenv("GAZEBO_RESOURCE_PATH",
         ((folder_.path() / "share/uuv").string() + ":" + (folder_.path() / "share/gazebo").string()).c_str(),
         1);
  for (const char* uri : {"file://Media/models/bed.obj", "Media/models/bed.obj", "file://models/bed.obj",
                          "file://media/meshes/rock.obj", "file://meshes/rock.obj"}) {
    EXPECT_EQ(load(mesh(uri)).triangle_count(), 1U) << uri;
  }
  unsetenv("GAZEBO_RESOURCE_PATH");
}

TEST_F(SearchList, BeginsBesideTheFileThatNamesIt) {
  environment("GZ_SIM_RESOURCE_PATH", "lib");
  folder_.write("project/worlds/post/meshes/a.obj", triangle_as_obj + "f 1 3 2\n");
  EXPECT_EQ(load(mesh("post/meshes/a.obj")).triangle_count(), 2U);
  folder_.write("project/models/rig/model.sdf", "<sdf version=\"1.9\">" + mesh("hull.obj") + "</sdf>");
  folder_.write("project/models/rig/hull.obj", triangle_as_obj + "f 1 3 2\nf 2 1 3\n");
  folder_.write("lib/hull.obj", triangle_as_obj);
  EXPECT_EQ(load(include("rig")).triangle_count(), 3U);
}

TEST_F(SearchList, IsPrintedIfNothingIsFound) {
  environment("GZ_SIM_RESOURCE_PATH", "lib");
  environment("SDF_PATH", "nowhere");
  for (const char* uri : {"buoy", "file://buoy/model.sdf", "model://buoy"}) {
    EXPECT_THAT(error_of(include(uri)),
                AllOf(HasSubstr("w.sdf:3: include '" + std::string(uri) + "' not found; looked in "),
                      HasSubstr((folder_.path() / "project/worlds").string()),
                      HasSubstr((folder_.path() / "lib").string()),
                      HasSubstr("; these folders do not exist: " + (folder_.path() / "nowhere").string())));
  }
}

TEST_F(SearchList, NamesEachAbsentFolderOnce) {
  for (const char* variable : {"GZ_SIM_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "SDF_PATH"}) {
    environment(variable, "nowhere");
  }
  const std::string message = error_of(include("buoy"));
  const std::string absent = (folder_.path() / "nowhere").string();
  EXPECT_THAT(message, HasSubstr("; these folders do not exist: " + absent + ";"));
  EXPECT_EQ(message.find(absent), message.rfind(absent));
}

TEST_F(SearchList, DoesNotReachOutOfItsFolders) {
  environment("GAZEBO_RESOURCE_PATH", "lib");
  folder_.write("secret/a.obj", triangle_as_obj);
  std::filesystem::create_symlink(folder_.path() / "secret/a.obj", folder_.path() / "lib/link.obj");
  std::filesystem::create_directory_symlink(folder_.path() / "secret", folder_.path() / "lib/media");
  for (const char* uri : {"file://../secret/a.obj", "file://../../secret/a.obj", "post/../../secret/a.obj",
                          "file://post/../../secret/a.obj", "link.obj", "model://link.obj"}) {
    EXPECT_THAT(error_of(mesh(uri)), HasSubstr("leads out of the folders of this world and its models"))
        << uri;
  }
  EXPECT_THAT(error_of(mesh("file://post/../post/meshes/a.obj")), "no error");
}

/// An archive of a world may hold links under the names that are searched.
TEST_F(SearchList, DoesNotFollowLinksInThePlaceOfItsFolders) {
  folder_.write("secret/a.obj", triangle_as_obj);
  std::filesystem::create_directories(folder_.path() / "project/worlds");
  for (const char* link : {"project/worlds/models", "project/models", "project/meshes"}) {
    std::filesystem::create_directory_symlink(folder_.path() / "secret", folder_.path() / link);
  }
  for (const char* uri : {"models/a.obj", "../models/a.obj", "../meshes/a.obj", "model://models/a.obj"}) {
    EXPECT_THAT(error_of(mesh(uri)), HasSubstr("leads out of the folders of this world and its models"))
        << uri;
  }
  EXPECT_THAT(error_of(mesh("model://a.obj")), HasSubstr("'model://a.obj' not found"));
}

TEST_F(SearchList, DoesNotNeedALight) {
  for (const char* uri : {"model://sun", "sun", "model://sun/model.sdf", "file://sun", "model://Sun Light",
                          "model://sky", "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Sun",
                          "https://fuel.ignitionrobotics.org/1.0/openrobotics/models/sun/2",
                          "http://models.gazebosim.org/sun"}) {
    const World world = load(include(uri));
    EXPECT_THAT(world.warnings, IsEmpty()) << uri;
    EXPECT_THAT(world.left_out, testing::Contains(HasSubstr("lights (1): "))) << uri;
  }
  EXPECT_THAT(error_of(include("model://sunken_wreck")), HasSubstr("'model://sunken_wreck' not found"));
  EXPECT_THAT(error_of(include("model://lighthouse")), HasSubstr("'model://lighthouse' not found"));
}

TEST_F(SearchList, HasALightThatIsThere) {
  folder_.write(
      "project/models/sun/model.sdf",
      "<sdf version=\"1.6\"><light name=\"sun\" type=\"directional\"><direction>0 0 -1</direction></light>"
      "</sdf>");
  folder_.write("project/models/lamp/model.sdf",
                "<sdf version=\"1.6\"><model name=\"lamp\"><link name=\"l\"><light name=\"bulb\" "
                "type=\"point\"/></link>"
                "</model></sdf>");
  const World world = load(include("model://sun") + include("lamp"));
  EXPECT_THAT(world.warnings, IsEmpty());
  EXPECT_THAT(world.left_out, testing::UnorderedElementsAre("lights (2): sun, lamp::l::bulb",
                                                            "models without shapes (1): lamp"));
}

}  // namespace
}  // namespace sonard::render
