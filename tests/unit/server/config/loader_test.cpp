// SPDX-License-Identifier: Apache-2.0
// Values that the loader reads from good configurations, and messages that complaints.txt cannot hold.
#include "server/config/loader.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <numbers>
#include <set>
#include <string>
#include <string_view>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/config/overlaps.hpp"
#include "server/devices/gemini/config.hpp"
#include "server/devices/gemini/type.hpp"
#include "server/devices/micron/type.hpp"
#include "server/devices/types/types.hpp"
#include "server/net/interfaces.hpp"
#include "server/pose/gazebo/input.hpp"
#include "server/pose/mavlink/input.hpp"
#include "server/pose/trajectory/input.hpp"
#include "tests/unit/server/config/config_text.hpp"

namespace sonard::server {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class Loader : public ConfigFolder {};

/// The first head, which must be a Gemini.
const GeminiConfig& gemini_of(const DaemonConfig& config) {
  return device_settings<GeminiConfig>(config.heads.at(0));
}

TEST_F(Loader, GivesDefaultsForWhatIsLeftOut) {
  const LoadedConfig loaded = load(minimal_config);
  const DaemonConfig& config = loaded.config;
  EXPECT_THAT(loaded.warning_lines(), IsEmpty());
  EXPECT_EQ(config.log.level, LogLevel::info);
  EXPECT_EQ(config.world.file, folder_ / "world.sdf");
  EXPECT_EQ(config.engine, render::EngineKind::automatic);
  ASSERT_TRUE(config.poses.T_world_vehicle_initial);
  EXPECT_EQ(config.poses.T_world_vehicle_initial->position_m, glm::dvec3(1, 2, 3));
  EXPECT_THAT(config.poses.inputs, IsEmpty());
  EXPECT_EQ(config.poses.extrapolation_limit, milliseconds{500});
  EXPECT_EQ(config.poses.stale_policy, StalePolicy::hold);

  ASSERT_EQ(config.heads.size(), 1U);
  const HeadConfig& head = config.heads[0];
  EXPECT_EQ(head.type, &gemini_type());
  EXPECT_EQ(head.name, "front");
  EXPECT_EQ(head.acoustics.model, render::Model::physical);
  EXPECT_FALSE(head.dump_directory);
  const GeminiConfig& gemini = device_settings<GeminiConfig>(head);
  EXPECT_EQ(gemini.device.sonar_id, 513);
  EXPECT_EQ(gemini.device.alternate_address, 0x7F000002U);
  EXPECT_EQ(gemini.device.netmask, 0xFF000000U);
  EXPECT_EQ(gemini.device.fixed_address, 0x0A3D13C8U);  // 10.61.19.200, protocol/gemini/README.md 1.2
  EXPECT_EQ(gemini.device.min_ping_period, std::chrono::microseconds{33'300});  // 8.4
  EXPECT_EQ(gemini.device.water_sound_speed_mps, 0.0);
  EXPECT_EQ(gemini.bind_address, 0x7F000002U);
  EXPECT_EQ(gemini.command_port, 52901);
  EXPECT_EQ(gemini.device.client_port, 52900);
  EXPECT_EQ(gemini.status.mode, StatusDestination::Mode::limited_broadcast);
  EXPECT_THAT(gemini.allow, ElementsAre(Cidr{0x7F000000, 8}));
  EXPECT_TRUE(gemini.link.to_client.transparent());
  EXPECT_TRUE(gemini.link.from_client.transparent());
  EXPECT_FALSE(gemini.trigger);
}

TEST_F(Loader, ReadsWhatTheGpuMayTake) {
  EXPECT_EQ(load(minimal_config).config.gpu.memory_mib, 4096U);
  EXPECT_EQ(load(minimal_config + "gpu: {memory_mib: 512}\n").config.gpu.memory_mib, 512U);
}

TEST_F(Loader, ReadsTheEngine) {
  EXPECT_EQ(load(minimal_config + "engine: auto\n").config.engine, render::EngineKind::automatic);
  EXPECT_EQ(load(minimal_config + "engine: gpu\n").config.engine, render::EngineKind::gpu);
  EXPECT_EQ(load(minimal_config + "engine: cpu\n").config.engine, render::EngineKind::cpu);
  const DaemonConfig config = load(minimal_config + "gpu: {device: 1, retry_s: 30}\n").config;
  EXPECT_EQ(config.gpu.device, "1");
  EXPECT_EQ(config.gpu.retry_s, 30.0);
}

TEST_F(Loader, StartsThePaperKeysFromAPreset) {
  const LoadedConfig loaded =
      load(minimal_config + "    acoustics: {paper: {preset: paper2018, speckle_mean: 0.9}}\n");
  const render::PaperModel& paper = loaded.config.heads.at(0).acoustics.paper;
  EXPECT_EQ(paper.speckle, render::PaperModel::Speckle::folded_gaussian);
  EXPECT_EQ(paper.speckle_mean, 0.9);
  EXPECT_EQ(paper.speckle_sd, 0.30);  // docs/physics.md 1.2, A8
  EXPECT_EQ(paper.speckle_floor, 0.03);
  EXPECT_GT(paper.attenuation_per_m, 0.0);
}

TEST_F(Loader, ComputesAbsorptionFromTheWaterAtTheFrequencyOfTheDevice) {
  // Fresh water: only the f^2 term remains, so 161.088 dB/km at 720 kHz (docs/physics.md 2.2) scales exactly.
  const LoadedConfig loaded =
      load(minimal_config + "water: {temperature_c: 10, salinity_ppt: 0, depth_m: 5, ph: 7}\n");
  const double expected_db_per_m = 0.161088 * std::pow(723.38 / 720.0, 2);
  const render::PhysicalModel& model = loaded.config.heads.at(0).acoustics.physical;
  EXPECT_NEAR(model.absorption_db_per_m, expected_db_per_m, 1e-6);
  EXPECT_NEAR(model.tvg.absorption_db_per_m, expected_db_per_m, 1e-6);
}

TEST_F(Loader, TakesWaterPropertiesThatAreGivenOutright) {
  const LoadedConfig loaded = load(minimal_config +
                                   "    acoustics: {physical: {tvg_absorption_db_per_km: 120}}\n"
                                   "water: {absorption_db_per_km: 80, sound_speed_mps: 1482.5}\n");
  const render::PhysicalModel& model = loaded.config.heads.at(0).acoustics.physical;
  EXPECT_DOUBLE_EQ(model.absorption_db_per_m, 0.080);
  EXPECT_DOUBLE_EQ(model.tvg.absorption_db_per_m, 0.120);
  EXPECT_DOUBLE_EQ(gemini_of(loaded.config).device.water_sound_speed_mps, 1482.5);
}

TEST_F(Loader, ComputesTheSpeedOfSoundWhenAskedTo) {
  const std::string water = "water: {temperature_c: 10, salinity_ppt: 35, depth_m: 10, sound_speed_mps: ";
  const auto speed_mps = [&](const std::string& word) {
    return gemini_of(load(minimal_config + water + word + "}\n").config).device.water_sound_speed_mps;
  };
  EXPECT_NEAR(speed_mps("computed"), 1489.97, 5e-3);  // Mackenzie, docs/physics.md 2.2
  EXPECT_EQ(speed_mps("ping_configuration"), 0.0);
}

TEST_F(Loader, TurnsRollPitchYawIntoARotation) {
  const LoadedConfig down =
      load(minimal_config + "    mount: {position_m: [0.5, 0, -0.25], rpy_deg: [0, 20, 0]}\n");
  const render::Pose& mount = down.config.heads.at(0).T_vehicle_sonar;
  EXPECT_EQ(mount.position_m, glm::dvec3(0.5, 0, -0.25));
  // With a tilt of 20 degrees down the acoustic axis points forward and down.
  const glm::dvec3 axis = mount.orientation * glm::dvec3(1, 0, 0);
  EXPECT_NEAR(axis.x, std::cos(20 * std::numbers::pi / 180), 1e-12);
  EXPECT_NEAR(axis.y, 0, 1e-12);
  EXPECT_NEAR(axis.z, -std::sin(20 * std::numbers::pi / 180), 1e-12);

  // Rz(90) Ry(0) Rx(90): the roll turns the body's y axis up, and the yaw leaves it there. x turns to the
  // left.
  const LoadedConfig rolled = load(minimal_config + "    mount: {rpy_deg: [90, 0, 90]}\n");
  const glm::dquat& q = rolled.config.heads.at(0).T_vehicle_sonar.orientation;
  EXPECT_NEAR(glm::length(q * glm::dvec3(0, 1, 0) - glm::dvec3(0, 0, 1)), 0, 1e-12);
  EXPECT_NEAR(glm::length(q * glm::dvec3(1, 0, 0) - glm::dvec3(0, 1, 0)), 0, 1e-12);
}

TEST_F(Loader, ReadsTheLinkAndItsUnits) {
  const LoadedConfig loaded = load(minimal_config +
                                   "    link:\n"
                                   "      seed: 18446744073709551615\n"
                                   "      to_client: {loss: 0.05, delay_ms: 1.5, jitter_ms: 0.25}\n"
                                   "      from_client: {reorder: 0.01, duplicate: 1}\n");
  const LinkConfig& link = gemini_of(loaded.config).link;
  EXPECT_EQ(link.seed, 18446744073709551615U);
  EXPECT_EQ(link.to_client.loss, 0.05);
  EXPECT_EQ(link.to_client.delay, std::chrono::microseconds{1500});
  EXPECT_EQ(link.to_client.jitter, std::chrono::microseconds{250});
  EXPECT_EQ(link.from_client.reorder, 0.01);
  EXPECT_EQ(link.from_client.duplicate, 1.0);
  EXPECT_FALSE(link.to_client.transparent());
}

TEST_F(Loader, ResolvesPathsAgainstTheFolderOfTheFile) {
  const LoadedConfig loaded = load(
      "world: {file: /somewhere/else.sdf}\n"
      "poses: {trajectory: {file: sub/t.csv, loop: true, speed: 2, axes: ned_frd}}\n" +
      minimal_config.substr(minimal_config.find("heads:")) + "    dump: {directory: pings}\n");
  EXPECT_EQ(loaded.config.world.file, "/somewhere/else.sdf");
  const auto* trajectory = settings_of<TrajectoryInput>(loaded.config.poses);
  ASSERT_NE(trajectory, nullptr);
  EXPECT_EQ(trajectory->file, folder_ / "sub/t.csv");
  EXPECT_EQ(trajectory->speed, 2.0);
  EXPECT_TRUE(trajectory->loop);
  EXPECT_EQ(trajectory->axes, pose::Axes::ned_frd);
  EXPECT_EQ(loaded.config.heads.at(0).dump_directory, folder_ / "pings");
}

TEST_F(Loader, KeepsThePlacesOfKeysForLaterProblems) {
  const LoadedConfig loaded = load(minimal_config);
  EXPECT_THAT(loaded.problem_with("world.file", "no such file"),
              HasSubstr("config.yaml:1:15: world.file: no such"));
  // A default has no place in the file. Problems name the key that it derives from, or else the mapping
  // around it.
  EXPECT_THAT(loaded.problem_with("heads[0].network.bind", "in use"),
              HasSubstr("config.yaml:9:26: heads[0].network.bind: in use"));
  EXPECT_THAT(loaded.problem_with("heads[0].network.command_port", "?"),
              HasSubstr("config.yaml:9:7: heads[0].net"));
}

// ---- Errors

TEST_F(Loader, SaysThatNoTildeIsExpanded) {
  EXPECT_THAT(complaints(minimal_config + "recording: {directory: ~/logs}\n"),
              ElementsAre(StartsWith("config.yaml:11:24: recording.directory: '~/logs' begins with ~, which "
                                     "sonard does not expand (expected an absolute path")));
  std::filesystem::create_directory(folder_ / "~");
  EXPECT_THAT(complaints(minimal_config + "recording: {directory: ~/logs}\n"), IsEmpty());
}

/// All names of keys, at any depth.
void add_names(const std::vector<KeyReference>& keys, std::set<std::string>& names) {
  for (const KeyReference& key : keys) {
    names.insert(key.name);
    add_names(key.keys, names);
  }
}

/// `path: value` as nested mappings: "a.b" and "1" make "{a: {b: 1}}".
std::string nested(std::string_view path, const std::string& value) {
  const std::size_t dot = path.find('.');
  return dot == std::string_view::npos
             ? fmt::format("{{{}: {}}}", path, value)
             : fmt::format("{{{}: {}}}", path.substr(0, dot), nested(path.substr(dot + 1), value));
}

/// The path that a problem offers instead of an unknown key; empty if it offers none.
std::string offered_in(const std::string& problem) {
  constexpr std::string_view front = "unknown key here, did you mean '";
  const std::size_t found = problem.find(front);
  const std::size_t begin = found + front.size();
  return found == std::string::npos ? "" : problem.substr(begin, problem.find('\'', begin) - begin);
}

TEST_F(Loader, OffersOnlyKeysThatAHeadOfThisTypeMayHave) {
  const auto is_known = [&](const std::string& text) {
    return std::ranges::none_of(complaints(text), [](const std::string& one) {
      return one.find("unknown key") != std::string::npos;
    });
  };
  std::set<std::string> names;
  for (const HeadType* const type : head_types()) {
    add_names(describe_config(*type), names);
  }
  names.erase("type");
  std::size_t offers = 0;
  for (const HeadType* const type : head_types()) {
    const std::string head = fmt::format("{{type: {}", type->name());
    const std::string all = fmt::format("heads: [{}, {}: 1}}]\n", head, fmt::join(names, ": 1, "));
    for (const std::string& problem : complaints(all)) {
      if (const std::string path = offered_in(problem); !path.empty()) {
        const std::string inner = nested(path, "1").substr(1);
        const bool in_head = is_known(fmt::format("heads: [{}, {}]\n", head, inner));
        EXPECT_TRUE(in_head || is_known(fmt::format("{{heads: [{}}}], {}\n", head, inner)))
            << type->name() << ": " << problem;
        ++offers;
      }
    }
  }
  EXPECT_GT(offers, 500U);
}

TEST_F(Loader, ReadsAKeyByItsFormerNameAndWarns) {
  const std::string former =
      minimal_config + "    timing: {surface_timeout_ms: 500}\n    link: {to_surface: {loss: 0.5}}\n";
  const LoadedConfig loaded = load(former);
  EXPECT_EQ(gemini_of(loaded.config).link.to_client.loss, 0.5);
  std::vector<std::string> lines;
  for (const ConfigProblem& warning : loaded.warnings) {
    lines.push_back(problem_text("config.yaml", warning));
  }
  EXPECT_THAT(lines, testing::IsSupersetOf(
                         {HasSubstr("config.yaml:11:34: heads[0].timing.client_timeout_ms: has its former "
                                    "name 'surface_timeout_ms' here; write 'client_timeout_ms'"),
                          HasSubstr("heads[0].link.to_client: has its former name 'to_surface' here")}));
}

TEST_F(Loader, NoiseFollowsFromABudget) {
  const auto physical = [&](const std::string& text) {
    return load(minimal_config + "    acoustics: {physical: " + text + "}\n");
  };
  const auto level_db = [&](const std::string& text) {
    return physical(text).config.heads.at(0).acoustics.physical.noise.level_db;
  };
  // -15 + 20 log10 723.38 - 30 + 10 log10 94000 - 200
  EXPECT_NEAR(level_db("{noise_budget: {}}"), -138.08, 0.01);
  EXPECT_NEAR(level_db("{noise_budget: {source_level_db: 210, spectral_level_db: 50, directivity_db: 20, "
                       "bandwidth_khz: 10}}"),
              -140, 1e-9);
}

TEST_F(Loader, AnInterfaceThatIsNotThereIsAMatterOfTheNetwork) {
  const auto trouble = [&](const std::string& address, const std::string& mask, const std::string& more) {
    std::string text = minimal_config + more;
    text.replace(text.find("127.0.0.2"), 9, address);
    text.replace(text.find("255.0.0.0"), 9, mask);
    std::ofstream(folder_ / "config.yaml") << text;
    try {
      load_config(folder_ / "config.yaml", head_types());
    } catch (const ConfigError& error) {
      return std::pair(error.kind == ErrorKind::network, error.lines());
    }
    return std::pair(false, std::vector<std::string>{});
  };
  const auto [later, lines] = trouble("usb77", "usb77", "");
  EXPECT_TRUE(later);
  EXPECT_THAT(lines,
              ElementsAre(HasSubstr("config.yaml:9:26: heads[0].network.alternate_address: there is no "
                                    "interface 'usb77' (yet); this machine has "),
                          HasSubstr("config.yaml:10:16: heads[0].network.netmask: there is no interface")));
  EXPECT_TRUE(trouble("usb77", "255.255.255.0", "").first);
  EXPECT_FALSE(trouble("usb77", "usb77", "engine: gpus\n").first) << "starting again does not help";
  EXPECT_FALSE(trouble("127.0.0.300", "usb77", "").first);
}

TEST_F(Loader, NamesTheInterfaceThatAHeadIsNamedBy) {
  std::string text = minimal_config;
  text.replace(text.find("127.0.0.2"), 9, "lo");
  text.replace(text.find("255.0.0.0"), 9, "lo");
  const DaemonConfig config = load(text).config;
  EXPECT_EQ(gemini_of(config).device.alternate_address, 0x7F000001U);
  EXPECT_EQ(gemini_of(config).interface, "lo");
  EXPECT_EQ(gemini_of(config).netmask_interface, "lo");
  EXPECT_EQ(gemini_of(load(minimal_config).config).interface, "");
}

TEST_F(Loader, ReadsWhereStatusPacketsGo) {
  const auto status = [&](const std::string& text) {
    return gemini_of(load(minimal_config + "      status: " + text + "\n").config).status;
  };
  EXPECT_THAT(status("[127.0.0.1, 127.0.0.9]").hosts, ElementsAre(0x7F000001U, 0x7F000009U));
  EXPECT_EQ(status("directed_broadcast").mode, StatusDestination::Mode::directed_broadcast);
}

TEST_F(Loader, ReadsMavlink) {
  const std::string initial = "  initial: {position_m: [1, 2, 3]}\n";
  const auto with = [&](const std::string& mavlink) {
    std::string text = minimal_config;
    return text.replace(text.find(initial), initial.size(), "  mavlink: {" + mavlink + "}\n");
  };
  const auto settings = [&](const std::string& mavlink) {
    return *settings_of<MavlinkPoseInput>(load(with(mavlink)).config.poses);
  };
  const MavlinkPoseInput plain = settings("bind: 127.0.0.1:14660");
  EXPECT_EQ(plain.bind, (Endpoint{0x7F000001, 14660}));
  EXPECT_EQ(plain.system_id, 1);
  EXPECT_EQ(plain.component_id, 1);
  EXPECT_EQ(plain.messages, MavlinkMessages::automatic);
  EXPECT_EQ(plain.T_world_local.position_m, glm::dvec3(0));
  const MavlinkPoseInput full = settings(
      "bind: 127.0.0.1:1, system_id: 7, component_id: 197, messages: local_position, "
      "origin: {position_m: [1, 2, 3], rpy_deg: [0, 0, -90]}");
  EXPECT_EQ(full.system_id, 7);
  EXPECT_EQ(full.component_id, 197);
  EXPECT_EQ(full.messages, MavlinkMessages::local_position);
  EXPECT_EQ(full.T_world_local.position_m, glm::dvec3(1, 2, 3));
  // The local frame's north is the world's east.
  EXPECT_NEAR((full.T_world_local.orientation * glm::dvec3(0, 1, 0)).x, 1, 1e-12);
}

TEST_F(Loader, TellsTheHeadsWhoseTimePingsKeep) {
  const std::string heads = minimal_config.substr(minimal_config.find("heads:"));
  const std::string world = "world: {file: w.sdf}\n";
  const auto loaded = [&](const std::string& clock) {
    return load(world + "poses: {udp: {bind: 127.0.0.1:1}" + clock + "}\n" + heads).config;
  };
  EXPECT_EQ(loaded("").poses.clock, PingClock::wall);
  EXPECT_FALSE(gemini_of(loaded("")).device.simulated_time);
  EXPECT_EQ(loaded(", clock: simulated").poses.clock, PingClock::simulated);
  EXPECT_EQ(loaded(", clock: simulated_lock_step").poses.clock, PingClock::simulated_lock_step);
  EXPECT_TRUE(gemini_of(loaded(", clock: simulated_lock_step")).device.simulated_time);
}

TEST_F(Loader, ReadsAValueByItsFormerNameAndWarns) {
  const std::string rest = minimal_config.substr(minimal_config.find("heads:"));
  const auto loaded = [&](const std::string& clock) {
    return load("world: {file: w.sdf}\nposes: {udp: {bind: 127.0.0.1:1}, clock: " + clock + "}\n" + rest);
  };
  const LoadedConfig lock_step = loaded("lock_step");
  EXPECT_EQ(lock_step.config.poses.clock, PingClock::simulated_lock_step);
  EXPECT_THAT(lock_step.warning_lines(),
              testing::Contains(HasSubstr("config.yaml:2:42: poses.clock: is 'lock_step', which is a former "
                                          "name; write 'simulated_lock_step'")));
  EXPECT_EQ(loaded("source").config.poses.clock, PingClock::simulated);
  EXPECT_THAT(loaded("simulated").warning_lines(), testing::Not(testing::Contains(HasSubstr("former name"))));
}

TEST_F(Loader, TakesOpenWaterForAWorld) {
  const std::string rest = minimal_config.substr(minimal_config.find("poses:"));
  for (const char* world : {"world: empty\n", "world: {empty: true}\n"}) {
    const LoadedConfig loaded = load(world + rest);
    EXPECT_TRUE(loaded.config.world.open_water) << world;
    EXPECT_EQ(loaded.config.world.file, "") << world;
    EXPECT_THAT(loaded.warning_lines(), IsEmpty());
  }
  const DaemonConfig both =
      load("world: {file: world.sdf, empty: true, origin: {latitude_deg: 1, longitude_deg: 2}}\n" + rest)
          .config;
  EXPECT_TRUE(both.world.open_water);
  EXPECT_EQ(both.world.file, folder_ / "world.sdf");
  EXPECT_FALSE(load(minimal_config).config.world.open_water);
}

TEST_F(Loader, LeavesTheVehicleOfGazeboToTheWorld) {
  const std::string initial = "  initial: {position_m: [1, 2, 3]}\n";
  const auto with = [&](const std::string& ignition) {
    std::string text = minimal_config;
    return text.replace(text.find(initial), initial.size(), "  gazebo: {topic: /p, " + ignition + "}\n");
  };
  const auto vehicle = [&](const std::string& gazebo) {
    return settings_of<GazeboPoseInput>(load(with(gazebo)).config.poses)->vehicle.name;
  };
  EXPECT_EQ(vehicle("frame: relative"), "");
  EXPECT_EQ(vehicle("frame: world, vehicle: rov"), "rov");
}

TEST_F(Loader, LeavesAMountToTheWorld) {
  const HeadConfig head =
      load(minimal_config + "    mount: {from_world: bow}\n    hides_vehicle: true\n").config.heads.at(0);
  EXPECT_EQ(head.mount_from_world, "bow");
  EXPECT_TRUE(head.hides_vehicle);
}

/// An item for the list of heads: a Micron with this `serial` section.
std::string micron_of(const std::string& name, int node, const std::string& serial) {
  return "  - {name: " + name + ", type: micron, serial: {" + serial +
         "}, device: {node: " + std::to_string(node) + "}}\n";
}

TEST_F(Loader, LetsHeadsOfTwoKindsHaveTheSameId) {
  std::string text = minimal_config + micron_of("mast", 2, "tcp: [{bind: 127.0.0.9:4001}]");
  text.replace(text.find("513"), 3, "2");
  const DaemonConfig config = load(text).config;
  ASSERT_EQ(config.heads.size(), 2U);
  for (const HeadConfig& head : config.heads) {
    EXPECT_EQ(head.type->device_id(head), 2);
  }
}

TEST_F(Loader, KnowsTheSocketsOfAllInputsAndHeadsByTheirTransport) {
  const std::string text =
      "world: {file: world.sdf}\n"
      "poses: {tcp: {bind: 127.0.0.1:1}, mavlink: {bind: 127.0.0.1:2}, udp: {bind: 127.0.0.1:3}}\n" +
      minimal_config.substr(minimal_config.find("heads:")) + "    trigger: {bind: 127.0.0.1:4}\n" +
      micron_of("mast", 2, "tcp: [{bind: 127.0.0.1:3}, {bind: 127.0.0.1:5}], udp: [{bind: 127.0.0.1:1}]");
  using Transport = PlannedSocket::Transport;
  std::vector<std::tuple<Transport, Endpoint, std::string>> sockets;
  for (const PlannedSocket& socket : planned_sockets(load(text).config)) {
    sockets.emplace_back(socket.transport, socket.endpoint, socket.key);
  }
  const auto at = [](std::uint16_t port) { return Endpoint{0x7F000001, port}; };
  EXPECT_THAT(sockets, testing::UnorderedElementsAre(
                           std::tuple(Transport::udp, at(3), "poses.udp.bind"),
                           std::tuple(Transport::udp, at(2), "poses.mavlink.bind"),
                           std::tuple(Transport::tcp, at(1), "poses.tcp.bind"),
                           std::tuple(Transport::udp, Endpoint{0x7F000002, 52901}, "heads[0].network.bind"),
                           std::tuple(Transport::udp, at(4), "heads[0].trigger.bind"),
                           std::tuple(Transport::udp, at(1), "heads[1].serial.udp[0].bind"),
                           std::tuple(Transport::tcp, at(3), "heads[1].serial.tcp[0].bind"),
                           std::tuple(Transport::tcp, at(5), "heads[1].serial.tcp[1].bind")));
}

TEST_F(Loader, NamesTheTypesThatAHeadCanBeOf) {
  std::vector<std::string_view> types;
  for (const HeadType* type : head_types()) {
    types.push_back(type->name());
  }
  ASSERT_THAT(types, testing::IsSupersetOf({"gemini_720i", "micron"}));
  std::string text = minimal_config;
  text.replace(text.find("gemini_720i"), 11, "gemini_7200");
  EXPECT_THAT(complaints(text),
              ElementsAre(fmt::format(
                  "config.yaml:6:11: heads[0].type: 'gemini_7200' is not understood, did you mean "
                  "'gemini_720i'? (expected one of {})",
                  fmt::join(types, ", "))));
  text = minimal_config;
  text.erase(text.find("    type"), std::string("    type: gemini_720i\n").size());
  EXPECT_THAT(complaints(text),
              ElementsAre(fmt::format("config.yaml:5:5: heads[0].type: missing (expected {})",
                                      fmt::join(types, " or "))));
}

TEST_F(Loader, TakesNoOtherTypesThanItIsGiven) {
  const std::string micron = micron_of("mast", 2, "tcp: [{bind: 127.0.0.9:4001}]");
  load(minimal_config + micron);  // load() writes the file
  const HeadType* const types[] = {&gemini_type()};
  try {
    load_config(folder_ / "config.yaml", types);
    FAIL() << "a head of another type";
  } catch (const ConfigError& error) {
    EXPECT_THAT(
        error.lines(),
        testing::Contains(HasSubstr(
            "config.yaml:11:24: heads[1].type: 'micron' is not understood (expected one of gemini_720i)")));
  }
}

TEST_F(Loader, ReadsTheErrorThatIsAimedAt) {
  const auto preset = [&](const std::string& section) {
    return load(minimal_config + section).config.heads.at(0).acoustics.sampling.preset;
  };
  using Preset = render::Sampling::Preset;
  EXPECT_EQ(preset(""), Preset::normal);
  EXPECT_EQ(preset("sampling: {preset: fast}\n"), Preset::fast);
  EXPECT_EQ(preset("sampling: {preset: reference}\n"), Preset::reference);
  EXPECT_EQ(preset("sampling: {preset: grid, rows: 64}\n"), Preset::grid);
  EXPECT_TRUE(
      load(minimal_config + "sampling: {adaptive_quality: on}\n").config.heads.at(0).adaptive_quality);
}

TEST_F(Loader, SaysWhichKeysTakeAnInterface) {
  const std::vector<InterfaceAddress> interfaces = interface_addresses();
  if (interfaces.empty()) {
    GTEST_SKIP() << "no interface has an address";
  }
  const InterfaceAddress& one = interfaces.front();
  EXPECT_THAT(
      complaints(fmt::format("world: {{file: w}}\nposes:\n  udp: {{bind: \"{}:14600\"}}\n", one.interface)),
      Contains(HasSubstr(
          fmt::format("poses.udp.bind: '{0}:14600' names an interface; only `alternate_address`, `address` "
                      "and `netmask` under `network` can (expected an address and port such as "
                      "127.0.0.1:14600; {0} has {1})",
                      one.interface, address_text(one.address)))));
}

TEST_F(Loader, SaysLittleAboutFilesThatAreFarTooLong) {
  std::string keys = minimal_config;
  for (int key = 0; key < 100'000; ++key) {
    keys += fmt::format("k{}: 1\n", key);
  }
  const std::clock_t start = std::clock();  // of this process, whatever else the machine does
  const std::vector<std::string> lines = complaints(keys);
  EXPECT_LT((std::clock() - start) / CLOCKS_PER_SEC, 30);
  ASSERT_EQ(lines.size(), 1001U);
  EXPECT_THAT(lines.back(), HasSubstr("99000 more problems are not shown"));

  const std::string long_word(1'000'000, 'x');
  for (const std::string& text : {minimal_config + "engine: " + long_word + "\n",
                                  minimal_config + long_word + ": 1\n" + long_word + ": 1\n",
                                  minimal_config + "water: {ph: " + long_word + "}\n"}) {
    for (const std::string& line : complaints(text)) {
      EXPECT_LT(line.size(), 1000U) << line.substr(0, 200);
    }
  }
  EXPECT_THAT(complaints(std::string(5'000'000, '#')),
              ElementsAre("config.yaml: is 5000000 bytes long (expected at most 4194304)"));
}

TEST_F(Loader, WantsOneDocumentThatIsAMapping) {
  // For this text, yaml-cpp returns documents without end.
  EXPECT_THAT(complaints("# a comment\n, world\n"),
              ElementsAre("config.yaml:2:1: this character cannot begin a value (expected valid YAML)"));
  EXPECT_THAT(complaints(""), ElementsAre("config.yaml: contains 0 YAML documents (expected one)"));
  EXPECT_THAT(complaints(minimal_config + "---\na: 1\n"),
              ElementsAre("config.yaml: contains 2 YAML documents (expected one)"));
  EXPECT_THAT(complaints("- 1\n")[0], HasSubstr("is a list (expected a mapping"));
}

TEST_F(Loader, SaysWhyAFileCannotBeRead) {
  try {
    load_config(folder_ / "absent.yaml", head_types());
    FAIL() << "loaded a file that is not there";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("absent.yaml: cannot be read: No such file or directory"));
  }
  EXPECT_THROW(load_config(folder_, head_types()), ConfigError);
}

}  // namespace
}  // namespace sonard::server
