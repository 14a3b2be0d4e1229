// SPDX-License-Identifier: Apache-2.0
#include "tests/gl/configurations/config_scenes.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "protocol/pose/trajectory.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "server/config/loader.hpp"
#include "server/daemon/daemon.hpp"
#include "server/daemon/resolve_mounts.hpp"
#include "server/devices/device_type.hpp"
#include "server/devices/types/types.hpp"
#include "server/pose/to_render.hpp"
#include "server/pose/trajectory/input.hpp"
#include "server/yaml/config_error.hpp"

namespace sonard::test {
namespace {

namespace fs = std::filesystem;
using server::DaemonConfig;
using server::HeadConfig;

const fs::path folder = SONARD_SOURCE_DIR "/configs";
const fs::path demos = folder / "demo/list.yaml";  // the list of `sonard demo`, not a configuration

std::vector<fs::path> configurations() {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml" && entry.path() != demos) {
      files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  return files;
}

/// A head may be named by an interface that this machine does not have; it then gets the loopback interface.
DaemonConfig load(const fs::path& file) {
  std::string text = server::read_config(file);
  try {
    return server::load_config(file, text, server::head_types()).config;
  } catch (const server::ConfigError& error) {
    if (error.kind != server::ErrorKind::network) {
      throw;
    }
  }
  const std::string missing = "eth0";
  for (std::size_t at = 0; (at = text.find(missing, at)) != std::string::npos;) {
    text.replace(at, missing.size(), "lo");
  }
  return server::load_config(file, text, server::head_types()).config;
}

/// Poses at the beginning of a trajectory, and at `more` times evenly spread over the rest.
void add_poses(const pose::Trajectory& trajectory, int more, std::vector<render::Pose>& poses) {
  const std::int64_t length_ns = trajectory.end_ns() - trajectory.start_ns();
  for (int i = 0; i <= more; ++i) {
    poses.push_back(
        server::to_render(trajectory.at(trajectory.start_ns() + length_ns * i / (more + 1)).T_world_vehicle));
  }
}

/// Poses of the vehicle that the configuration itself gives, or the demo with it; may be empty.
std::vector<render::Pose> own_poses(const DaemonConfig& config, const render::World& world, int more) {
  std::vector<render::Pose> poses;
  if (config.poses.T_world_vehicle_initial) {
    poses.push_back(*config.poses.T_world_vehicle_initial);
  }
  if (const auto* trajectory = server::settings_of<server::TrajectoryInput>(config.poses)) {
    add_poses(pose::load_trajectory(trajectory->file, trajectory->axes), more, poses);
  }
  for (const auto& demo : YAML::LoadFile(demos.string())) {
    if (more > 0 && folder / demo.second["configuration"].as<std::string>() == config.file) {
      add_poses(pose::load_trajectory(folder / demo.second["trajectory"].as<std::string>()), more, poses);
    }
  }
  if (const render::Body* vehicle = world.find_body(config.world.vehicle_model); vehicle != nullptr) {
    poses.push_back(vehicle->T_world_body);
  }
  return poses;
}

bool is_near(const render::Pose& a, const render::Pose& b) {
  constexpr double rounding = 1e-5;  // of files
  return glm::distance(a.position_m, b.position_m) < rounding &&
         std::abs(glm::dot(a.orientation, b.orientation)) > 1 - rounding * rounding;
}

bool is_equal(const render::SonarSettings& a, const render::SonarSettings& b) {
  return a.aperture == b.aperture && a.range == b.range && a.model == b.model && a.paper == b.paper &&
         a.physical == b.physical && a.sampling == b.sampling && a.transmit == b.transmit;
}

/// Whether both can be rendered by the same renderer.
bool has_same_world(const ConfigScene& a, const ConfigScene& b) {
  return a.world_file == b.world_file && a.options.skip == b.options.skip &&
         a.options.ray_curvature_per_m == b.options.ray_curvature_per_m;
}

bool is_same(const ConfigScene& a, const ConfigScene& b) {
  return has_same_world(a, b) && a.bodies == b.bodies &&
         std::ranges::equal(a.T_world_sonar, b.T_world_sonar, is_near) && is_equal(a.settings, b.settings);
}

/// The scene of a head. @param bearings of a scanning head
ConfigScene scene_of(const DaemonConfig& config, const HeadConfig& head, const render::Pose& T_world_vehicle,
                     int bearings) {
  ConfigScene scene;
  scene.name = config.file.filename().string() + ": " + head.name;
  scene.types = {std::string(head.type->name())};
  scene.world_file = config.world.file;
  scene.options = server::renderer_options(config);
  if (!config.world.vehicle_model.empty()) {
    const render::Pose out_of_sight{{0, 0, -1e6}, {1, 0, 0, 0}};
    scene.bodies = {{config.world.vehicle_model, head.hides_vehicle ? out_of_sight : T_world_vehicle}};
  }
  const render::PingRequest ping = server::usual_ping(head, T_world_vehicle);
  scene.settings = ping.settings;
  if (scene.settings.sampling.preset != render::Sampling::Preset::grid) {
    scene.settings.sampling.preset = render::Sampling::Preset::normal;
  }
  const int count = server::type_of(head).scanning() ? bearings : 1;
  for (int i = 0; i < count; ++i) {
    scene.T_world_sonar.push_back(
        server::T_world_transducer(ping.T_world_sonar, 2 * std::numbers::pi * i / count));
  }
  return scene;
}

}  // namespace

ConfigScenes config_scenes(int more_poses, int bearings) {
  ConfigScenes all;
  std::vector<DaemonConfig> configs;
  for (const fs::path& file : configurations()) {
    DaemonConfig config = load(file);
    if (!all.worlds.contains(config.world.file)) {
      all.worlds[config.world.file] = server::read_world(config.world);
    }
    if (!server::resolve_mounts(config, all.worlds[config.world.file]).empty()) {
      throw std::runtime_error(file.string() + ": the world does not give the mounts");
    }
    configs.push_back(std::move(config));
  }

  std::map<fs::path, render::Pose> first_poses;
  for (const DaemonConfig& config : configs) {
    if (const auto poses = own_poses(config, all.worlds[config.world.file], 0); !poses.empty()) {
      first_poses.emplace(config.world.file, poses.front());
    }
  }

  for (const DaemonConfig& config : configs) {
    std::vector<render::Pose> poses = own_poses(config, all.worlds[config.world.file], more_poses);
    if (poses.empty()) {
      if (!first_poses.contains(config.world.file)) {
        throw std::runtime_error(config.file.string() + ": no configuration gives a pose in its world");
      }
      poses.push_back(first_poses[config.world.file]);
    }
    for (const HeadConfig& head : config.heads) {
      for (const render::Pose& T_world_vehicle : poses) {
        ConfigScene scene = scene_of(config, head, T_world_vehicle, bearings);
        const auto same =
            std::ranges::find_if(all.scenes, [&](const ConfigScene& other) { return is_same(scene, other); });
        if (same == all.scenes.end()) {
          all.scenes.push_back(std::move(scene));
        } else {
          same->name += ", " + scene.name;
          same->types.merge(scene.types);
        }
      }
    }
  }
  return all;
}

namespace {

/// RMS of the difference of engine `gpu` from engine `cpu`, re the RMS of the image of `cpu`.
struct EngineDifference {
  double rms = 0.0;
  bool by_gpu = true;  ///< the GPU made all images
  double gpu_s = 0.0, cpu_s = 0.0;
};

/// Both engines in one world.
class BothEngines {
 public:
  BothEngines(const render::World& world, const render::RendererOptions& options)
      : gpu_(world, with(options, render::EngineKind::gpu)),
        cpu_(world, with(options, render::EngineKind::cpu)) {}

  EngineDifference compare(const ConfigScene& scene) {
    for (render::SonarRenderer* renderer : {&gpu_, &cpu_}) {
      for (const auto& [name, T_world_body] : scene.bodies) {
        renderer->set_body_pose(name, T_world_body);
      }
    }
    EngineDifference found;
    double squares = 0, squares_off = 0;
    for (const render::Pose& T_world_sonar : scene.T_world_sonar) {
      const render::PingRequest request{T_world_sonar, scene.settings, 0, 1};
      const std::vector<float> gpu = timed(gpu_, request, found.gpu_s);
      found.by_gpu =
          found.by_gpu && gpu_.engine() == render::EngineKind::gpu && gpu_.last_statistics().gpu.passes > 0;
      const std::vector<float> cpu = timed(cpu_, request, found.cpu_s);
      for (std::size_t i = 0; i < cpu.size(); ++i) {
        const auto echo = static_cast<double>(cpu[i]), off = static_cast<double>(gpu[i]) - echo;
        squares += echo * echo;
        squares_off += off * off;
      }
    }
    found.rms = std::sqrt(squares_off / squares);  // not a number without an echo, which fails each limit
    return found;
  }

 private:
  static render::RendererOptions with(render::RendererOptions options, render::EngineKind engine) {
    options.engine = engine;
    return options;
  }

  static std::vector<float> timed(render::SonarRenderer& renderer, const render::PingRequest& request,
                                  double& spent_s) {
    const auto before = std::chrono::steady_clock::now();
    std::vector<float> image = request.settings.directions.any()
                                   ? renderer.render_directions(request).intensity
                                   : renderer.render_echo(request).intensity;
    spent_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    return image;
  }

  render::SonarRenderer gpu_, cpu_;
};

ConfigScene middle_beams(ConfigScene scene, int beams) {
  std::vector<double>& edges = scene.settings.aperture.beam_edges_rad;
  const int first = (scene.settings.aperture.beam_count() - beams) / 2;
  if (first > 0) {
    edges = {edges.begin() + first, edges.begin() + first + beams + 1};
  }
  return scene;
}

constexpr double promised = 1e-3;

bool sample_equal_directions(const render::SonarSettings& settings) {
  return !render::needs_grid(settings) && !render::has_conical_beams(settings);
}

}  // namespace

void expect_agreement(const ConfigScenes& all, int beams) {
  std::set<std::string> types;
  for (const ConfigScene& scene : all.scenes) {
    types.insert(scene.types.begin(), scene.types.end());
  }
  for (const server::DeviceType* type : server::device_types()) {
    EXPECT_TRUE(types.contains(std::string(type->name()))) << "no configuration has a " << type->name();
  }
  // One pair of engines for each world and its options.
  std::vector<bool> done(all.scenes.size());
  for (std::size_t first = 0; first < all.scenes.size(); ++first) {
    if (done[first]) {
      continue;
    }
    const ConfigScene& of_world = all.scenes[first];
    BothEngines both(all.worlds.at(of_world.world_file), of_world.options);
    for (std::size_t i = first; i < all.scenes.size(); ++i) {
      const ConfigScene& scene = all.scenes[i];
      if (done[i] || !has_same_world(scene, of_world)) {
        continue;
      }
      done[i] = true;
      const EngineDifference found = both.compare(middle_beams(scene, beams));
      const bool has_promise = sample_equal_directions(scene.settings);
      std::printf("%.1e %s (gpu %.1f s, cpu %.2f s) %s, %s\n", found.rms,
                  has_promise ? "" : "without a limit", found.gpu_s, found.cpu_s,
                  scene.world_file.filename().c_str(), scene.name.c_str());
      std::fflush(stdout);
      // The CPU alone renders directions (renderer/engines/README.md).
      EXPECT_EQ(found.by_gpu, !scene.settings.directions.any()) << scene.name << ": by the wrong engine";
      EXPECT_TRUE(!has_promise || found.rms <= promised) << scene.name << ": " << found.rms;
    }
  }
}

}  // namespace sonard::test
