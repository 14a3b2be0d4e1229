// SPDX-License-Identifier: Apache-2.0
// The files of configs/ load without a warning, and the two that scripts use have the values that these need.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "protocol/pose/trajectory.hpp"
#include "server/config/loader.hpp"
#include "server/devices/gemini/config.hpp"
#include "server/devices/gemini/type.hpp"
#include "server/devices/types/types.hpp"
#include "server/pose/udp/input.hpp"

namespace sonard::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const std::filesystem::path configs = std::filesystem::path(SONARD_SOURCE_DIR) / "configs";

TEST(ShippedConfigs, LoadWithoutWarnings) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(configs)) {
    if (entry.path().extension() == ".yaml") {
      ++files;
      EXPECT_THAT(load_config(entry.path(), head_types()).warning_lines(), IsEmpty()) << entry.path();
    }
  }
  EXPECT_GE(files, 4);
}

TEST(ShippedConfigs, TellEditorsTheirSchema) {
  for (const auto& entry : std::filesystem::directory_iterator(configs)) {
    if (entry.path().extension() == ".yaml") {
      std::string first;
      std::getline(std::ifstream(entry.path()), first);
      EXPECT_EQ(first, "# yaml-language-server: $schema=schema/sonard.schema.json") << entry.path();
    }
  }
}

/// Collects the paths of keys that have no sentence in the reference.
void find_silent(const std::vector<KeyReference>& keys, const std::string& path,
                 std::vector<std::string>& silent) {
  for (const KeyReference& key : keys) {
    if (key.meaning.empty()) {
      silent.push_back(path + key.name);
    }
    find_silent(key.keys, path + key.name + ".", silent);
  }
}

TEST(ShippedConfigs, EveryKeyOfTheSchemaHasItsSentence) {
  for (const HeadType* type : head_types()) {
    std::vector<std::string> silent;
    find_silent(describe_config(*type), "", silent);
    EXPECT_THAT(silent, IsEmpty()) << type->name();
  }
}

TEST(ShippedConfigs, TrajectoriesLoad) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(configs / "trajectories")) {
    ++files;
    EXPECT_GT(pose::load_trajectory(entry.path()).points().size(), 1U) << entry.path();
  }
  EXPECT_GE(files, 6);
}

DaemonConfig shipped(const char* file) {
  return load_config(configs / file, head_types()).config;
}

void expect_demo_head(const DaemonConfig& config) {
  ASSERT_EQ(config.heads.size(), 1U);
  const HeadConfig& head = config.heads[0];
  ASSERT_EQ(head.type, &gemini_type());
  EXPECT_EQ(device_settings<GeminiConfig>(head).device.sonar_id, 513);
  EXPECT_EQ(device_settings<GeminiConfig>(head).command_port, 52901);
  EXPECT_EQ(device_settings<GeminiConfig>(head).device.client_port, 52900);
  EXPECT_EQ(head.acoustics.model, render::Model::physical);
  EXPECT_EQ(settings_of<UdpPoseInput>(config.poses)->bind, (Endpoint{0x7F000001, 14600}));
  EXPECT_TRUE(config.poses.T_world_vehicle_initial.has_value());
  const double pi = std::numbers::pi;
  EXPECT_NEAR((head.T_vehicle_sonar.orientation * glm::dvec3(1, 0, 0)).z, -std::sin(20 * pi / 180), 1e-12);
}

TEST(ShippedConfigs, DemoStartsWhereItsTrajectoryStarts) {
  const pose::Transform first =
      pose::load_trajectory(configs / "trajectories" / "docking_demo.csv").points().front().T_world_vehicle;
  for (const char* file : {"demo.yaml", "gemini-netns.yaml", "paper.yaml"}) {
    const render::Pose initial = shipped(file).poses.T_world_vehicle_initial.value();
    const glm::dvec3 position(first.position_m.x, first.position_m.y, first.position_m.z);
    EXPECT_LT(glm::length(initial.position_m - position), 1e-3) << file;
    const glm::dquat q(first.orientation.w, first.orientation.x, first.orientation.y, first.orientation.z);
    EXPECT_GT(std::abs(glm::dot(initial.orientation, q)), 1 - 1e-6) << file;
  }
}

TEST(ShippedConfigs, DemoServesLoopback) {
  const DaemonConfig config = shipped("demo.yaml");
  expect_demo_head(config);
  const GeminiConfig& head = device_settings<GeminiConfig>(config.heads[0]);
  EXPECT_EQ(head.bind_address, 0x7F000002U);
  EXPECT_EQ(head.device.alternate_address, 0x7F000002U);
  EXPECT_EQ(head.device.netmask, 0xFF000000U);
  EXPECT_EQ(head.status.mode, StatusDestination::Mode::unicast);
  EXPECT_THAT(head.status.hosts, ElementsAre(0x7F000001U));
}

TEST(ShippedConfigs, GeminiNetnsIsFoundByBroadcast) {
  const DaemonConfig config = shipped("gemini-netns.yaml");
  expect_demo_head(config);
  const GeminiConfig& head = device_settings<GeminiConfig>(config.heads[0]);
  EXPECT_EQ(head.bind_address, 0x0A3D13C8U);
  EXPECT_EQ(head.device.alternate_address, 0x0A3D13C8U);
  EXPECT_EQ(head.device.netmask, 0xFFFFFF00U);
  EXPECT_EQ(head.status.mode, StatusDestination::Mode::limited_broadcast);
  EXPECT_THAT(head.allow, ElementsAre(Cidr{0x0A3D1300, 24}));
}

TEST(ShippedConfigs, TwoVehiclesRunSideBySide) {
  const DaemonConfig a = shipped("two-vehicles-a.yaml");
  const DaemonConfig b = shipped("two-vehicles-b.yaml");
  ASSERT_EQ(a.heads.size(), 2U);
  ASSERT_EQ(b.heads.size(), 1U);
  EXPECT_NE(settings_of<UdpPoseInput>(a.poses)->bind, settings_of<UdpPoseInput>(b.poses)->bind);
  const GeminiConfig& gemini_a = device_settings<GeminiConfig>(a.heads[0]);
  const GeminiConfig& gemini_b = device_settings<GeminiConfig>(b.heads[0]);
  EXPECT_NE(gemini_a.device.sonar_id, gemini_b.device.sonar_id);
  EXPECT_NE(gemini_a.bind_address, gemini_b.bind_address);
  EXPECT_NE(gemini_a.status.hosts, gemini_b.status.hosts);
}

TEST(ShippedConfigs, PaperUsesTheModelOfThePaper) {
  EXPECT_EQ(shipped("paper.yaml").heads.at(0).acoustics.model, render::Model::paper);
}

}  // namespace
}  // namespace sonard::server
