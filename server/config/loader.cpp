// SPDX-License-Identifier: Apache-2.0
#include "server/config/loader.hpp"

#include <cerrno>
#include <fstream>
#include <sstream>
#include <system_error>

#include <fmt/format.h>

#include "renderer/acoustics/water.hpp"
#include "server/config/head_section.hpp"
#include "server/config/network_section.hpp"
#include "server/config/overlaps.hpp"
#include "server/config/yaml_section.hpp"
#include "server/net/addresses.hpp"

namespace sonard::server {
namespace {

std::string read_file(const std::filesystem::path& file) {
  const auto fail = [&](const std::error_code& cause) {
    throw ConfigError(file,
                      {{{}, "", fmt::format("cannot be read: {} (expected a YAML file)", cause.message())}});
  };
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) {
    fail(std::make_error_code(std::errc::is_a_directory));
  }
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    fail({errno, std::generic_category()});
  }
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

YAML::Node parse_yaml(const std::filesystem::path& file) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(read_file(file));
    if (documents.size() != 1) {
      throw ConfigError(file,
                        {{{}, "", fmt::format("holds {} YAML documents (expected one)", documents.size())}});
    }
    return documents.front();
  } catch (const YAML::Exception& error) {
    throw ConfigError(file,
                      {{position_of(error.mark), "", fmt::format("{} (expected valid YAML)", error.msg)}});
  }
}

void read_log(YamlSection& section, LogLevel& level) {
  section.choice("level", level,
                 {{"trace", LogLevel::trace},
                  {"debug", LogLevel::debug},
                  {"info", LogLevel::info},
                  {"warn", LogLevel::warn},
                  {"error", LogLevel::error}});
}

render::Water properties(const WaterConfig& water) {
  return {water.temperature_c, water.salinity_ppt, water.depth_m, water.ph};
}

/// Fills the water and what the heads take from it.
void read_water(YamlSection& section, HeadContext& context) {
  WaterConfig& water = context.water;
  section.number("temperature_c", water.temperature_c, Range::from(-4.0, 45.0));
  section.number("salinity_ppt", water.salinity_ppt, Range::from(0.0, 50.0));
  section.number("depth_m", water.depth_m, Range::from(0.0, 11'000.0));
  section.number("ph", water.ph, Range::from(5.0, 10.0));
  double absorption_db_per_km = -1.0;
  section.number_or_word("absorption_db_per_km", absorption_db_per_km, Range::from(0.0, 10'000.0),
                         {{"computed", -1.0}});
  context.absorption_db_per_m = absorption_db_per_km < 0.0 ? -1.0 : absorption_db_per_km / 1000.0;
  section.number_or_word(
      "sound_speed_mps", context.water_sound_speed_mps, Range::from(1000.0, 2000.0),
      {{"ping_configuration", 0.0}, {"computed", render::sound_speed_mps(properties(water))}});
  section.number("sound_speed_gradient_per_s", water.sound_speed_gradient_per_s, Range::from(-10.0, 10.0));
}

void read_trajectory(YamlSection& section, const std::filesystem::path& folder, TrajectoryInput& trajectory) {
  std::string path;
  section.require("file", "a trajectory file, CSV or TUM");
  section.text("file", path);
  trajectory.file = folder / path;
  section.boolean("loop", trajectory.loop);
  section.number("speed", trajectory.speed, Range::above(0.0, 1000.0));
  section.choice("axes", trajectory.axes,
                 {{"enu_flu", pose::Axes::enu_flu}, {"ned_frd", pose::Axes::ned_frd}});
}

void read_mavlink(YamlSection& section, MavlinkPoseInput& mavlink) {
  section.require("bind", expected_endpoint);
  section.parsed("bind", mavlink.bind, &parse_endpoint, expected_endpoint);
  read_allow_list(section, mavlink.bind.address, mavlink.allow);
  section.integer("system_id", mavlink.system_id, 1, 255);
  section.integer("component_id", mavlink.component_id, 1, 255);
  section.choice("messages", mavlink.messages,
                 {{"auto", MavlinkMessages::automatic},
                  {"odometry", MavlinkMessages::odometry},
                  {"local_position", MavlinkMessages::local_position}});
  section.section("origin", [&](YamlSection& inner) { read_pose(inner, mavlink.T_world_local); });
}

std::optional<std::string> any_text(std::string_view text) {
  return text.empty() ? std::nullopt : std::optional(std::string(text));
}

/// `name_key` and "parents", which says what a relative pose is relative to.
void read_entity(YamlSection& section, std::string_view name_key, bool relative, SimulatorEntity& entity) {
  section.text(name_key, entity.name);
  section.parsed_list("parents", entity.parents, &any_text, "names of entities, the outermost first");
  if (!relative && section.has("parents")) {
    section.report("parents", "poses in the world have no parents (expected only with `frame: relative`)");
  }
}

void read_ignition(YamlSection& section, IgnitionPoseInput& ignition) {
  enum class Frame { world, relative };
  Frame frame = Frame::world;
  section.require("topic", "a topic such as /world/ocean/dynamic_pose/info");
  section.text("topic", ignition.topic);
  section.text("partition", ignition.partition);
  section.require("frame", "world, or relative for poses that are relative to parents");
  section.choice("frame", frame, {{"world", Frame::world}, {"relative", Frame::relative}});
  const bool relative = frame == Frame::relative;
  read_entity(section, "vehicle", relative, ignition.vehicle);
  const bool named = section.has("vehicle");
  if (relative && named) {
    section.require("parents",
                    "what the vehicle's pose is relative to, the outermost first; [] for a model "
                    "that stands in the world");
  }
  for (const char* key : {"parents", "mount"}) {
    if (!named && section.has(key)) {
      section.report(key, "is of `vehicle`, which is not given (expected both, or neither)");
    }
  }
  section.section("mount", [&](YamlSection& inner) { read_pose(inner, ignition.T_entity_vehicle); });
  section.sections("bodies", [&](YamlSection& inner) {
    IgnitionPoseInput::Body& body = ignition.bodies.emplace_back();
    inner.require("entity", "the name of an entity of the simulator");
    read_entity(inner, "entity", relative, body.entity);
    inner.require("body", "the name of a model of the world");
    inner.text("body", body.body);
  });
}

void read_poses(YamlSection& section, const std::filesystem::path& folder, PoseConfig& poses) {
  section.section("initial", [&](YamlSection& inner) {
    inner.require("position_m", "a list of three numbers");
    read_pose(inner, poses.T_world_vehicle_initial.emplace());
  });
  section.section("udp", [&](YamlSection& inner) {
    UdpPoseInput& udp = poses.udp.emplace();
    inner.require("bind", expected_endpoint);
    inner.parsed("bind", udp.bind, &parse_endpoint, expected_endpoint);
    read_allow_list(inner, udp.bind.address, udp.allow);
  });
  section.section("tcp", [&](YamlSection& inner) {
    TcpPoseInput& tcp = poses.tcp.emplace();
    inner.require("bind", expected_endpoint);
    inner.parsed("bind", tcp.bind, &parse_endpoint, expected_endpoint);
    read_allow_list(inner, tcp.bind.address, tcp.allow);
    inner.integer("max_clients", tcp.max_clients, 1, 1000);
  });
  section.section("mavlink", [&](YamlSection& inner) { read_mavlink(inner, poses.mavlink.emplace()); });
  section.section("trajectory",
                  [&](YamlSection& inner) { read_trajectory(inner, folder, poses.trajectory.emplace()); });
  section.section("ignition", [&](YamlSection& inner) { read_ignition(inner, poses.ignition.emplace()); });
  section.duration("extrapolation_limit_ms", poses.extrapolation_limit, Range::from(0.0, 60'000.0));
  section.choice("stale", poses.stale_policy,
                 {{"hold", StalePolicy::hold}, {"silence", StalePolicy::silence}});
  section.choice(
      "clock", poses.clock,
      {{"wall", PingClock::wall}, {"source", PingClock::source}, {"lock_step", PingClock::lock_step}});

  const bool live = poses.udp || poses.tcp || poses.mavlink || poses.ignition;
  if (live && poses.trajectory) {
    section.report("trajectory",
                   "the trajectory and a live input would fight over the vehicle (expected one of them)");
  }
  if (!live && !poses.trajectory && !poses.T_world_vehicle_initial) {
    section.report("initial",
                   "nothing gives a pose (expected initial, udp, tcp, mavlink, ignition or trajectory)");
  }
  if (!live && !poses.trajectory && poses.clock != PingClock::wall) {
    section.report("clock",
                   "no source of poses has a clock (expected wall, or udp, tcp, mavlink, ignition or "
                   "trajectory beside it)");
  }
}

void read_sampling(YamlSection& section, render::Sampling& sampling) {
  using Preset = render::Sampling::Preset;
  section.choice("preset", sampling.preset,
                 {{"fast", Preset::fast},
                  {"default", Preset::normal},
                  {"reference", Preset::reference},
                  {"grid", Preset::grid}});
  section.integer("views", sampling.views, 1, 32);
  section.integer("columns_per_view", sampling.columns_per_view, 8, 4096);
  section.integer("rows", sampling.rows, 8, 4096);
  if (sampling.preset != Preset::grid) {
    for (const char* key : {"views", "columns_per_view", "rows"}) {
      if (section.has(key)) {
        section.report(key, "a preset chooses its samples by itself (expected only with `preset: grid`)");
      }
    }
  }
}

void read_skip(YamlSection& section, render::SkipSwitches& skip) {
  std::vector<std::string_view> names;
  for (const render::SkipRuleEntry& entry : render::skip_rules) {
    names.push_back(entry.name);
  }
  std::vector<render::SkipRule> off;
  section.parsed_list("off", off, &render::skip_rule_named, fmt::format("one of {}", fmt::join(names, ", ")));
  for (const render::SkipRule rule : off) {
    skip.turn_off(rule);
  }
}

void read_recording(YamlSection& section, const std::filesystem::path& folder, RecordingConfig& recording) {
  std::string path;
  section.require("directory", "a folder for the logs");
  section.text("directory", path);
  recording.directory = folder / path;
  section.boolean("glf", recording.glf);
  section.boolean("mcap", recording.mcap);
  section.boolean("pcapng", recording.pcapng);
  if (!recording.glf && !recording.mcap && !recording.pcapng) {
    section.report("directory", "no kind of log is to be written (expected glf, mcap or pcapng to be true)");
  }
  std::uint64_t mebibytes = recording.rotate_bytes >> 20;
  section.integer("rotate_mib", mebibytes, 1, 1800);  // a .glf holds 1907 MiB, and a ping may still come
  recording.rotate_bytes = mebibytes << 20;
  double minutes = std::chrono::duration<double, std::ratio<60>>(recording.rotate_after).count();
  section.number("rotate_min", minutes, Range::from(0.05, 10'080.0));
  recording.rotate_after = std::chrono::nanoseconds{static_cast<std::int64_t>(minutes * 60e9)};
  section.choice("zone", recording.zone, {{"utc", RecordingZone::utc}, {"local", RecordingZone::local}});
  section.choice("sync", recording.sync,
                 {{"never", RecordingSync::never},
                  {"on_close", RecordingSync::on_close},
                  {"every_second", RecordingSync::every_second}});
  mebibytes = recording.queue_bytes >> 20;
  section.integer("queue_mib", mebibytes, 1, 16'384);
  recording.queue_bytes = mebibytes << 20;
}

void read_document(YamlSection& root, std::span<const HeadKind* const> kinds, DaemonConfig& config,
                   std::vector<ConfigWarning>& warnings) {
  HeadContext context;
  context.folder = config.file.parent_path();
  root.section("log", [&](YamlSection& section) { read_log(section, config.log_level); });
  root.require("world", "a mapping with the world's file");
  root.section("world", [&](YamlSection& section) {
    std::string path;
    section.require("file", "an SDF world");
    section.text("file", path);
    config.world_file = context.folder / path;
    section.text("vehicle_model", config.vehicle_model);
  });
  root.choice("backend", config.backend,
              {{"auto", render::Backend::automatic},
               {"raster", render::Backend::raster},
               {"ray", render::Backend::ray}});
  root.choice("gpu_binning", config.gpu_binning,
              {{"auto", render::GpuBinning::automatic},
               {"on", render::GpuBinning::on},
               {"off", render::GpuBinning::off}});
  root.section("skip", [&](YamlSection& section) { read_skip(section, config.skip); });
  root.section("water", [&](YamlSection& section) { read_water(section, context); });
  context.water.sound_speed_mps = render::sound_speed_mps(properties(context.water));
  config.water = context.water;
  root.require("poses", "a mapping that says where poses come from");
  root.section("poses", [&](YamlSection& section) { read_poses(section, context.folder, config.poses); });
  context.pings_by_source = config.poses.clock != PingClock::wall;
  root.section("sampling", [&](YamlSection& section) { read_sampling(section, context.sampling); });
  root.section("recording", [&](YamlSection& section) {
    read_recording(section, context.folder, config.recording.emplace());
  });
  root.require("heads", "a list of sonar heads");
  root.sections("heads", [&](YamlSection& section) {
    config.heads.push_back(read_head(section, context, kinds, warnings));
  });
  if (root.is_list("heads") && config.heads.empty()) {
    root.report("heads", "no head is listed (expected at least one)");
  }
}

}  // namespace

LoadedConfig load_config(const std::filesystem::path& file, std::span<const HeadKind* const> kinds) {
  const YAML::Node document = parse_yaml(file);
  YamlFindings findings;
  LoadedConfig loaded;
  loaded.config.file = file;
  std::vector<ConfigWarning> warnings;
  {
    YamlSection root(findings, document, "");
    read_document(root, kinds, loaded.config, warnings);
  }
  if (findings.problems.empty()) {
    findings.problems = find_overlaps(loaded.config, findings.positions);
  }
  if (!findings.problems.empty()) {
    throw ConfigError(file, std::move(findings.problems));
  }
  loaded.positions = std::move(findings.positions);
  for (const ConfigWarning& warning : warnings) {
    loaded.warnings.push_back(loaded.problem_with(warning.key, warning.message));
  }
  return loaded;
}

std::string LoadedConfig::problem_with(std::string_view key, const std::string& message) const {
  return problem_text(config.file, {nearest_position(positions, key), std::string(key), message});
}

}  // namespace sonard::server
