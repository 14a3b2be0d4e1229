// SPDX-License-Identifier: Apache-2.0
// Everything that a configuration of configs/ shows a sonar: worlds, heads and poses.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "renderer/pose.hpp"
#include "renderer/renderer_options.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::test {

/// One head at one pose of its vehicle, with the pings that its clients usually request.
struct ConfigScene {
  std::string name;  ///< of all configurations with this scene: "demo.yaml, recording.yaml: gemini"
  std::set<std::string> types;  ///< of the head
  std::filesystem::path world_file;
  render::RendererOptions options;             ///< of the configuration
  std::map<std::string, render::Pose> bodies;  ///< that are not at their pose in the world
  render::SonarSettings settings;              ///< preset `default`, if the head has a preset
  std::vector<render::Pose> T_world_sonar;     ///< of a fan: one; of a scanning head: one for each bearing
};

/// The worlds of these scenes, and the scenes.
struct ConfigScenes {
  std::map<std::filesystem::path, render::World> worlds;
  std::vector<ConfigScene> scenes;  ///< without duplicates
};

/// Reads all configurations of configs/. A vehicle is at its first pose, and at `more_poses` poses evenly
/// spread over the rest of its trajectory. A configuration without a pose gets the first pose of another one
/// with the same world.
/// @param bearings of scanning heads, evenly spread over a turn
/// @throws std::runtime_error if a configuration has no pose, or cannot be read
ConfigScenes config_scenes(int more_poses, int bearings);

/// In each scene, with preset `default` and before speckle and noise, the image of engine `gpu` must be that
/// of `cpu`: RMS of the difference over RMS of the image, over all bins of a fan or of all bearings of a
/// turn, within 1e-3. For fixed grids and conical beams nothing is promised, because the engines sample other
/// directions: the difference is only printed.
///
/// All types of heads must occur. Prints one line for each scene.
/// @param beams in the middle of each fan that are rendered
void expect_agreement(const ConfigScenes& all, int beams);

}  // namespace sonard::test
