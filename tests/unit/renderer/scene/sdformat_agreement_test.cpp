// SPDX-License-Identifier: Apache-2.0
// sonard's reading of SDF against libsdformat, an independent implementation: names of models, and poses of
// visuals.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <ignition/math/Pose3.hh>
#include <sdf/Link.hh>
#include <sdf/Model.hh>
#include <sdf/ParserConfig.hh>
#include <sdf/Root.hh>
#include <sdf/SemanticPose.hh>
#include <sdf/Visual.hh>
#include <sdf/World.hh>

#include "renderer/scene/world.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

namespace fs = std::filesystem;

ignition::math::Pose3d resolved(const sdf::SemanticPose& semantic, const std::string& relative_to) {
  ignition::math::Pose3d pose;
  EXPECT_TRUE(semantic.Resolve(pose, relative_to).empty());
  return pose;
}

/// Poses of all visuals of a model in the model, nested models included.
void add_visuals(const sdf::Model& model, const ignition::math::Pose3d& T_body_model,
                 std::vector<ignition::math::Pose3d>& poses) {
  for (std::uint64_t i = 0; i < model.LinkCount(); ++i) {
    const sdf::Link& link = *model.LinkByIndex(i);
    for (std::uint64_t k = 0; k < link.VisualCount(); ++k) {
      poses.push_back(T_body_model * resolved(link.VisualByIndex(k)->SemanticPose(), "__model__"));
    }
  }
  for (std::uint64_t i = 0; i < model.ModelCount(); ++i) {
    const sdf::Model& nested = *model.ModelByIndex(i);
    add_visuals(nested, T_body_model * resolved(nested.SemanticPose(), ""), poses);
  }
}

bool same(const Pose& ours, const ignition::math::Pose3d& theirs) {
  const glm::dvec3 position(theirs.Pos().X(), theirs.Pos().Y(), theirs.Pos().Z());
  const glm::dquat turn(theirs.Rot().W(), theirs.Rot().X(), theirs.Rot().Y(), theirs.Rot().Z());
  return glm::distance(ours.position_m, position) < 1e-9 * (1 + glm::length(position)) &&
         std::abs(std::abs(glm::dot(ours.orientation, turn)) - 1) < 1e-12;
}

void expect_agreement(const fs::path& file) {
  SCOPED_TRACE(file);
  sdf::ParserConfig config;
  config.SetFindCallback([&](const std::string& uri) {
    const std::string name = uri.substr(uri.starts_with("model://") ? 8 : 0);
    for (const fs::path& folder : {file.parent_path() / "models", file.parent_path()}) {
      if (fs::exists(folder / name)) {
        return (folder / name).string();
      }
    }
    return std::string();
  });
  sdf::Root root;
  const sdf::Errors errors = root.Load(file.string(), config);
  ASSERT_TRUE(errors.empty()) << errors.front().Message();
  const sdf::World& theirs = *root.WorldByIndex(0);
  const World ours = load_world(file, {});
  ASSERT_EQ(ours.bodies.size(), theirs.ModelCount());
  for (std::uint64_t i = 0; i < theirs.ModelCount(); ++i) {
    const sdf::Model& model = *theirs.ModelByIndex(i);
    SCOPED_TRACE(model.Name());
    const Body* const body = ours.find_body(model.Name());
    ASSERT_NE(body, nullptr);
    EXPECT_TRUE(same(body->T_world_body, resolved(model.SemanticPose(), "")));
    std::vector<ignition::math::Pose3d> visuals;
    add_visuals(model, {}, visuals);
    EXPECT_GE(body->parts.size(), visuals.size()) << "a mesh may have several parts";
    for (const ignition::math::Pose3d& visual : visuals) {
      EXPECT_TRUE(std::ranges::any_of(body->parts, [&](const BodyPart& part) {
        return same(part.T_body_part, visual);
      })) << visual;
    }
  }
}

TEST(SdformatAgreement, OnTheHarbour) {
  expect_agreement(fs::path(SONARD_SOURCE_DIR) / "tests/data/worlds/harbour/harbour.sdf");
}

TEST(SdformatAgreement, OnTheWorldsThatShip) {
  for (const char* name : {"docking_station", "tank", "ssiv", "manifold"}) {
    expect_agreement(fs::path(SONARD_SOURCE_DIR) / "configs/worlds" / (std::string(name) + ".sdf"));
  }
}

/// Frames, placement frames, joints, nested scopes, merges and old spellings, which the worlds above lack.
TEST(SdformatAgreement, OnEveryRuleOfFrames) {
  const std::string ball =
      "<visual name='v'><pose>0.1 0.2 0.3 0.4 0.5 "
      "0.6</pose><geometry><sphere><radius>1</radius></sphere></geometry></visual>";
  const test::TempFolder folder;
  folder.write("models/arm/model.config",
               "<model><name>arm</name><sdf version='1.9'>model.sdf</sdf></model>");
  folder.write(
      "models/arm/model.sdf",
      "<sdf version='1.9'><model name='arm'><pose>0 0 1 0 0 0.3</pose><link name='upper'><pose>1 0 0 0 0.2 "
      "0</pose>" +
          ball + "</link><link name='fore'><pose relative_to='upper'>0.5 0 0 0 0 1</pose>" + ball +
          "</link><frame name='grip' attached_to='fore'><pose>0.2 0 0 0.7 0 0</pose></frame></model></sdf>");
  folder.write("models/old/model.config",
               "<model><name>old</name><sdf version='1.6'>model.sdf</sdf></model>");
  folder.write("models/old/model.sdf",
               "<sdf version='1.6'><model name='old'><link name='l'><pose>0 1 0 0 0 0</pose>" + ball +
                   "</link></model></sdf>");
  expect_agreement(folder.write(
      "w.sdf",
      "<sdf version='1.9'><world name='w'><frame name='quay'><pose>10 0 0 0 0 1</pose></frame>"
      "<frame name='edge' attached_to='quay'><pose>0 2 0 0 0 0</pose></frame>"
      "<model name='a'><pose relative_to='edge'>1 2 3 0.1 0.2 0.3</pose><link name='l'>" +
          ball +
          "</link>"
          "<joint name='j' type='fixed'><parent>l</parent><child>k</child><pose>0 0 0.5 0 0 0</pose></joint>"
          "<link name='k'><pose>0 3 0 0 0 0</pose>" +
          ball +
          "</link>"
          "<link name='m'><pose relative_to='j'>0 0 1 0 0 0</pose>" +
          ball +
          "</link>"
          "<model name='n'><pose relative_to='k'>1 0 0 0 0 0.5</pose><link name='x'><pose>0 0 1 0 0 "
          "0</pose>" +
          ball +
          "</link></model>"
          "<link name='o'><pose relative_to='n::x'>1 1 1 0 0 0</pose>" +
          ball +
          "</link></model>"
          "<model name='p' placement_frame='s'><pose>5 5 5 0 0 1</pose><link name='s'><pose>1 0 0 0 0 "
          "1</pose>" +
          ball +
          "</link></model>"
          "<include><uri>model://arm</uri><name>arm1</name><pose relative_to='a::l'>3 0 0 0 0 "
          "0</pose></include>"
          "<include><uri>model://arm</uri><name>arm2</name><placement_frame>grip</placement_frame><pose "
          "degrees='true'>0 0 2 0 0 90</pose></include>"
          "<include><uri>model://arm</uri><name>arm3</name></include>"
          "<include><uri>model://old</uri></include>"
          "<model name='rov'><link name='hull'>" +
          ball +
          "</link>"
          "<include merge='true'><uri>model://arm</uri><pose relative_to='hull'>1 0 2 0 0 "
          "0</pose></include></model>"
          "</world></sdf>"));
}

}  // namespace
}  // namespace sonard::render
