// SPDX-License-Identifier: Apache-2.0
#include "server/config/loader.hpp"

#include <array>
#include <cerrno>
#include <fstream>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "renderer/acoustics/water.hpp"
#include "server/config/head_section.hpp"
#include "server/config/network_section.hpp"
#include "server/config/overlaps.hpp"
#include "server/config/status_section.hpp"
#include "server/config/yaml_section.hpp"
#include "server/config/yaml_trouble.hpp"
#include "server/config/yaml_unclosed.hpp"
#include "server/net/addresses.hpp"

namespace sonard::server {
namespace {

constexpr std::uintmax_t most_bytes = 4
                                      << 20;  // a thousand times those that ship; more takes minutes to parse

std::string read_file(const std::filesystem::path& file) {
  const auto fail = [&](const std::error_code& cause) {
    throw ConfigError(file,
                      {{{}, "", fmt::format("cannot be read: {} (expected a YAML file)", cause.message())}});
  };
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) {
    fail(std::make_error_code(std::errc::is_a_directory));
  }
  if (const std::uintmax_t bytes = std::filesystem::file_size(file, ignored);
      !ignored && bytes > most_bytes) {
    throw ConfigError(file,
                      {{{}, "", fmt::format("is {} bytes long (expected at most {})", bytes, most_bytes)}});
  }
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    fail({errno, std::generic_category()});
  }
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Notes where the documents of a text begin.
class DocumentStarts : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override { marks.push_back(mark); }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
  }
  void OnMapEnd() override {}

  std::vector<YAML::Mark> marks;
};

/// How many documents there are: 0, 1 or, for more than that, 2. (YAML::LoadAll() finds documents without end
/// in a text that begins with a comma.)
/// @throws YAML::Exception
int count_documents(const std::string& text) {
  std::istringstream in(text);
  YAML::Parser parser(in);
  DocumentStarts starts;
  while (starts.marks.size() < 2 && parser.HandleNextDocument(starts)) {
  }
  if (starts.marks.size() == 2 && starts.marks[0].pos == starts.marks[1].pos) {
    throw YAML::ParserException(starts.marks[1], "nothing can begin with this character");
  }
  return static_cast<int>(starts.marks.size());
}

YAML::Node parse_yaml(const std::filesystem::path& file, const std::string& text) {
  try {
    if (const int documents = count_documents(text); documents != 1) {
      throw ConfigError(file, {{{}, "", fmt::format("holds {} YAML documents (expected one)", documents)}});
    }
    YAML::Node document = YAML::Load(text);
    if (const auto endless = find_endless_quote(text)) {
      throw ConfigError(file, {*endless});
    }
    return document;
  } catch (const YAML::Exception& error) {
    throw ConfigError(file, {yaml_trouble(text, position_of(error.mark), error.msg)});
  }
}

void read_log(YamlSection& section, LogLevel& level, LogFormat& format) {
  section.choice("level", level,
                 {{"trace", LogLevel::trace},
                  {"debug", LogLevel::debug},
                  {"info", LogLevel::info},
                  {"warn", LogLevel::warn},
                  {"error", LogLevel::error}},
                 "least severe events shown; `--log-level` overrides it");
  section.choice("format", format, {{"text", LogFormat::text}, {"json", LogFormat::json}},
                 "`json` writes each line as a JSON object for programs that collect logs "
                 "([deploy.md](deploy.md#logs-for-programs)); `--log-format` overrides it");
}

void read_world(YamlSection& section, const std::filesystem::path& folder, DaemonConfig& config) {
  section.path("file", config.world_file, folder, "SDF world ([worlds.md](worlds.md))");
  section.default_is("file", "**required**, unless `empty` is true");
  section.boolean(
      "empty", config.open_water,
      "whether the world may be without a surface, as open water is: images then hold noise and water "
      "clutter alone. Without `file` there is nothing but water. `world: empty` is short for "
      "`world: {empty: true}`");
  if (!config.open_water && !section.describing()) {
    section.require("file", "an SDF world; for open water, empty: true");
  }
  section.choice(
      "missing", config.skips_missing_files, {{"error", false}, {"skip", true}},
      "what becomes of an include, or a mesh, whose file is not there: the daemon does not start, or it does "
      "without, and warns");
  section.integer(
      "max_triangles", config.world_max_triangles, 1, 2'000'000'000,
      "most triangles of the world, each use of a mesh counted: a world that has more is refused");
  section.text("vehicle_model", config.vehicle_model,
               "model of the world that is the vehicle itself: it moves as the vehicle does, whatever the "
               "pose stream says of a body of this name. Its frame is the vehicle's");
  section.default_is("vehicle_model", "the model with the sonars of `mount.from_world`; without any, none");
  section.section("origin",
                  "where the world's (0, 0, 0) is on Earth, in the place of `<spherical_coordinates>` in the "
                  "file: maps and "
                  "GLOBAL_POSITION_INT need it ([worlds.md](worlds.md#where-on-earth))",
                  [&](YamlSection& inner) {
                    render::GeographicOrigin& origin = config.origin.emplace();
                    inner.require("latitude_deg", "degrees, WGS 84, north is positive");
                    inner.require("longitude_deg", "degrees, WGS 84, east is positive");
                    inner.number("latitude_deg", origin.latitude_deg, Range::from(-90.0, 90.0),
                                 "WGS 84, north is positive");
                    inner.number("longitude_deg", origin.longitude_deg, Range::from(-180.0, 180.0),
                                 "WGS 84, east is positive");
                    inner.number("altitude_m", origin.altitude_m, Range::from(-12'000.0, 9'000.0),
                                 "of z = 0 above mean sea level, metres");
                  });
}

render::Water properties(const WaterConfig& water) {
  return {water.temperature_c, water.salinity_ppt, water.depth_m, water.ph};
}

/// Fills the water and what the heads take from it.
void read_water(YamlSection& section, HeadContext& context) {
  section.introduce(
      "Sets the absorption (Francois & Garrison 1982, at the frequency of each head) and, if asked to, the "
      "true speed of sound (Mackenzie 1981; Medwin 1975 outside 2 to 30 degrees or 25 to 40 ppt).");
  WaterConfig& water = context.water;
  section.number("temperature_c", water.temperature_c, Range::from(-4.0, 45.0), "degrees Celsius");
  section.number("salinity_ppt", water.salinity_ppt, Range::from(0.0, 50.0),
                 "parts per thousand; 0 is fresh water");
  section.number("depth_m", water.depth_m, Range::from(0.0, 11'000.0),
                 "depth for these formulas; it does not follow the vehicle");
  section.number("ph", water.ph, Range::from(5.0, 10.0), "acidity; hardly matters above 100 kHz");
  double absorption_db_per_km = -1.0;
  section.number_or_word("absorption_db_per_km", absorption_db_per_km, Range::from(0.0, 10'000.0),
                         {{"computed", -1.0}},
                         "one way; computed outside -2 to 30 degrees or 30 to 35 ppt it is an extrapolation, "
                         "and a warning says so");
  context.absorption_db_per_m = absorption_db_per_km < 0.0 ? -1.0 : absorption_db_per_km / 1000.0;
  section.number_or_word(
      "sound_speed_mps", context.water_sound_speed_mps, Range::from(1000.0, 2000.0),
      {{"ping_configuration", 0.0}, {"computed", render::sound_speed_mps(properties(water))}},
      "true speed of sound. With `ping_configuration` the water has the speed the client assumes (where the "
      "head is not told, 1500 m/s), so its ranges are true; otherwise ranges are off by the ratio, as at "
      "sea");
  section.number(
      "sound_speed_gradient_per_s", water.sound_speed_gradient_per_s, Range::from(-10.0, 10.0),
      "by how much sound gets faster per metre upwards (m/s per m). 0: it goes straight. Warm water above "
      "cold, 0.5 to 1.8: rays sink, echoes of the bed come nearer. Water of one temperature: -0.017, which "
      "no sonar here would notice. Facets are divided for it ([acoustics.md](acoustics.md#refraction))");
}

void read_trajectory(YamlSection& section, const std::filesystem::path& folder, TrajectoryInput& trajectory) {
  section.require("file", "a trajectory file, CSV or TUM");
  section.path("file", trajectory.file, folder, "CSV or TUM ([poses.md](poses.md))");
  section.boolean("loop", trajectory.loop,
                  "start again at the end; otherwise the last pose stays the newest");
  section.number("speed", trajectory.speed, Range::above(0.0, 1000.0), "2: twice as fast as recorded");
  section.choice("axes", trajectory.axes,
                 {{"enu_flu", pose::Axes::enu_flu}, {"ned_frd", pose::Axes::ned_frd}},
                 "axes of world and vehicle in the file");
}

void read_mavlink(YamlSection& section, MavlinkPoseInput& mavlink) {
  read_socket(section, mavlink.bind, mavlink.allow, endpoint_form, "the example uses 127.0.0.1:14660",
              "who may send");
  section.integer("system_id", mavlink.system_id, 1, 255, "the vehicle; messages of others are ignored");
  section.integer("component_id", mavlink.component_id, 1, 255,
                  "the part of the vehicle that is believed; 1 is the autopilot");
  section.choice(
      "messages", mavlink.messages,
      {{"auto", MavlinkMessages::automatic},
       {"odometry", MavlinkMessages::odometry},
       {"local_position", MavlinkMessages::local_position},
       {"global_position", MavlinkMessages::global_position}},
      "ODOMETRY, or LOCAL_POSITION_NED or GLOBAL_POSITION_INT with the attitude of its time. `auto` takes "
      "the "
      "first of these that comes; GLOBAL_POSITION_INT needs a world with an `origin`, or is at latitude 0, "
      "longitude 0 and then gives the depth alone");
  section.section("origin", "where the vehicle's own origin is in the world", [&](YamlSection& inner) {
    read_pose(inner, mavlink.T_world_local,
              "what the vehicle calls (0, 0, 0), in the world (x east, y north, z up), metres",
              "as in `poses.initial`; yaw 90 turns the vehicle's north to west of the world");
  });
}

std::optional<std::string> any_text(std::string_view text) {
  return text.empty() ? std::nullopt : std::optional(std::string(text));
}

/// "parents", which says what a relative pose is relative to.
void read_parents(YamlSection& section, bool relative, SimulatorEntity& entity, std::string_view meaning) {
  constexpr TextForm names{"names of entities, the outermost first", "texts", R"("type": "string")"};
  section.parsed_list("parents", entity.parents, &any_text, names, meaning);
  if (!relative && section.has("parents")) {
    section.report("parents", "poses in the world have no parents (expected only with `frame: relative`)");
  }
}

void read_ignition(YamlSection& section, IgnitionPoseInput& ignition) {
  enum class Frame { world, relative };
  Frame frame = Frame::world;
  section.require("topic", "a topic such as /world/ocean/dynamic_pose/info");
  section.text("topic", ignition.topic, "with messages `Pose_V` or `Pose`");
  section.text("partition", ignition.partition, "of the transport");
  section.default_is("partition", "that of `IGN_PARTITION`");
  read_own_address(
      section, "address", ignition.address,
      "this machine's address on the network to Gazebo, instead of `IGN_IP` or `GZ_IP`. An "
      "address of loopback: Gazebo on this machine only. Any other: whoever reaches that network "
      "can publish poses");
  section.require("frame", "world, or relative for poses that are relative to parents");
  section.choice("frame", frame, {{"world", Frame::world}, {"relative", Frame::relative}},
                 "what poses are relative to: the world, or `parents`");
  const bool relative = frame == Frame::relative;
  section.text("vehicle", ignition.vehicle.name,
               "entity that carries the sonars; **required** where no model is the vehicle");
  section.default_is("vehicle", "`world.vehicle_model`, and with `relative` no parents");
  read_parents(section, relative, ignition.vehicle,
               "what its pose is relative to, the outermost first; [] for a model that stands in the world");
  section.default_is("parents", "**required** with `relative` and `vehicle`");
  const bool named = section.has("vehicle");
  if (relative && named) {
    section.require("parents",
                    "what the vehicle's pose is relative to, the outermost first; [] for a model that stands "
                    "in the world");
  }
  for (const char* key : {"parents", "mount"}) {
    if (!named && section.has(key)) {
      section.report(key, "is of `vehicle`, which is not given (expected both, or neither)");
    }
  }
  section.section("mount", "where the vehicle frame sits on the entity; only with `vehicle`",
                  [&](YamlSection& inner) {
                    read_pose(inner, ignition.T_entity_vehicle, "in the axes of the entity, metres",
                              "as in `poses.initial`");
                  });
  section.sections("bodies", "entities that move bodies of the world", [&](YamlSection& inner) {
    IgnitionPoseInput::Body& body = ignition.bodies.emplace_back();
    inner.require("entity", "the name of an entity of the simulator");
    inner.text("entity", body.entity.name, "name in the simulator");
    read_parents(inner, relative, body.entity, "only with `frame: relative`, as above");
    inner.require("body", "the name of a model of the world");
    inner.text("body", body.body, "name of the model in the world here");
  });
}

void read_poses(YamlSection& section, const std::filesystem::path& folder, PoseConfig& poses) {
  section.introduce(
      "At least one of `initial`, `udp`, `tcp`, `mavlink`, `ignition` and `trajectory`; a trajectory "
      "excludes the live inputs.");
  section.section(
      "initial", "pose until the first one arrives; without it the heads answer but do not ping before that",
      [&](YamlSection& inner) {
        inner.require("position_m", "a list of three numbers");
        read_pose(inner, poses.T_world_vehicle_initial.emplace(),
                  "origin of the vehicle in the world (x east, y north, z up), metres",
                  "roll, pitch, yaw about the fixed x, y and z axes, in this order; vehicle x forward, y to "
                  "port, z up, so positive pitch is nose down and positive yaw turns to port");
      });
  section.section("udp", "one pose message per datagram ([poses.md](poses.md))", [&](YamlSection& inner) {
    UdpPoseInput& udp = poses.udp.emplace();
    read_socket(inner, udp.bind, udp.allow, endpoint_form, "the demo uses 127.0.0.1:14600",
                "who may publish");
  });
  section.section("tcp", "varint-delimited pose messages ([poses.md](poses.md))", [&](YamlSection& inner) {
    TcpPoseInput& tcp = poses.tcp.emplace();
    read_socket(inner, tcp.bind, tcp.allow, endpoint_form, "where publishers connect", "who may publish");
    inner.integer("max_clients", tcp.max_clients, 1, 1000, "further connections are closed at once");
  });
  section.section("mavlink",
                  "telemetry of a MAVLink vehicle by UDP ([simulators/ardusub.md](simulators/ardusub.md))",
                  [&](YamlSection& inner) { read_mavlink(inner, poses.mavlink.emplace()); });
  section.section("ignition", "a pose topic of Gazebo ([simulators/gazebo.md](simulators/gazebo.md))",
                  [&](YamlSection& inner) { read_ignition(inner, poses.ignition.emplace()); });
  section.section("trajectory", "a file, played from the start of the daemon",
                  [&](YamlSection& inner) { read_trajectory(inner, folder, poses.trajectory.emplace()); });
  section.duration("extrapolation_limit_ms", poses.extrapolation_limit, Range::from(0.0, 60'000.0),
                   "past the newest pose the twist is followed (without one the pose is held) for this long");
  section.choice(
      "stale", poses.stale_policy, {{"hold", StalePolicy::hold}, {"silence", StalePolicy::silence}},
      "after that: go on from the last pose, or stop pinging (status packets go on) until a pose arrives");
  section.choice(
      "clock", poses.clock,
      {{"wall", PingClock::wall}, {"source", PingClock::source}, {"lock_step", PingClock::lock_step}},
      "whose time pings keep: this machine's, or that of the stamps of the poses, for a simulation that is "
      "slow, fast or paused; `lock_step` leaves no ping out, however slow the rendering "
      "([poses.md](poses.md#time-of-the-simulation))");

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

void read_sampling(YamlSection& section, render::Sampling& sampling, bool& adaptive_quality) {
  section.introduce(
      "The error of the echo that is aimed at; what it takes is found by itself. See "
      "[accuracy.md](accuracy.md) for what is measured and [benchmark.md](benchmark.md) for what it costs.");
  using Preset = render::Sampling::Preset;
  section.choice("preset", sampling.preset,
                 {{"fast", Preset::fast},
                  {"default", Preset::normal},
                  {"reference", Preset::reference},
                  {"grid", Preset::grid}},
                 "5 %, 1 %, as close as it gets (for offline use), or a fixed grid of samples");
  section.integer("views", sampling.views, 1, 32,
                  "only with `grid`, like the two below: side-by-side views across the fan; more are used "
                  "where one would exceed 60 degrees");
  section.integer("columns_per_view", sampling.columns_per_view, 8, 4096, "pixels of a view across the fan");
  section.integer("rows", sampling.rows, 8, 4096, "pixels over the elevation of the fan");
  section.choice(
      "adaptive_quality", adaptive_quality, {{"off", false}, {"on", true}},
      "`on` takes the next faster preset while a client asks for more pings than this machine can make, "
      "and comes back when there is time; the log says so. Images then depend on the machine and its "
      "load. Not with `grid`; without effect where poses bring the time (`poses.clock`)");
  if (sampling.preset == Preset::grid && adaptive_quality) {
    section.report("adaptive_quality", "a grid has no faster preset (expected off, or another `preset`)");
  }
  if (sampling.preset != Preset::grid) {
    for (const char* key : {"views", "columns_per_view", "rows"}) {
      if (section.has(key)) {
        section.report(key, "a preset chooses its samples by itself (expected only with `preset: grid`)");
      }
    }
  }
}

void read_gpu(YamlSection& section, render::GpuOptions& gpu) {
  section.introduce("Only where the engine is `gpu`, or `auto` takes it ([gpu.md](gpu.md)).");
  section.text(
      "device", gpu.device,
      "which EGL device: its number in the list of `sonard selftest`, or a part of its name there. Without "
      "it, hardware comes before software, then most memory");
  section.integer(
      "memory_mib", gpu.memory_mib, 1, 1'048'576,
      "MiB of video memory for meshes and normal maps, for each renderer: all fans share one, all "
      "scanning heads another. What was not drawn for the longest time makes room; if what one "
      "sonar sees does not fit, the CPU goes on ([engines.md](engines.md#video-memory))");
  section.number(
      "retry_s", gpu.retry_s, Range::from(0.0, 86'400.0),
      "after a loss of the GPU it is tried again each time so long has passed, in the middle of a ping, "
      "which then waits for it; 0: the CPU goes on to the end");
}

void read_skip(YamlSection& section, render::SkipSwitches& skip) {
  section.introduce(
      "The daemon leaves out what does not change the image, by rules that [skipping.md](skipping.md) lists "
      "with what each may change and saves. How often each did is in the log.");
  std::vector<std::string_view> names;
  for (const render::SkipRuleEntry& entry : render::skip_rules) {
    names.push_back(entry.name);
  }
  const std::string expected = fmt::format("one of {}", fmt::join(names, ", "));
  const std::string schema = fmt::format(R"("enum": ["{}"])", fmt::join(names, R"(", ")"));
  std::vector<render::SkipRule> off;
  section.parsed_list("off", off, &render::skip_rule_named, {expected, "rules", schema},
                      "these do not apply: what they would leave out is worked out in full");
  for (const render::SkipRule rule : off) {
    skip.turn_off(rule);
  }
}

void read_recording(YamlSection& section, const std::filesystem::path& folder, RecordingConfig& recording) {
  section.introduce(
      "Logs that users' tools open, of all heads. [logs.md](logs.md#5-recording) says what is in them, what "
      "happens when the disk is full, and what a daemon that was killed leaves behind.");
  section.require("directory", "a folder for the logs");
  section.path("directory", recording.directory, folder,
               "folder of the logs, made when it is not there; one daemon at a time records into it");
  section.boolean("glf", recording.glf, "a `.glf` of each head whose users know such logs");
  section.boolean("mcap", recording.mcap, "one MCAP file: images, poses, and the bytes of both directions");
  section.boolean("mcap_wire_bytes", recording.mcap_wire_bytes,
                  "whether these bytes are in it; a capture has them too, and images and replay do without");
  section.boolean("mcap_foxglove", recording.mcap_foxglove,
                  "whether each ping is in it as Foxglove shows it, too: a picture, the place of the sonar, "
                  "and echoes as points. It takes the time to draw a picture for each ping");
  section.choice("mcap_compression", recording.mcap_zstd, {{"none", false}, {"zstd", true}},
                 "of each mebibyte or second of it, when that is full: `zstd` takes some processor time for "
                 "a smaller file");
  section.boolean("pcapng", recording.pcapng, "one capture for Wireshark: the bytes of both directions");
  if (!recording.glf && !recording.mcap && !recording.pcapng) {
    section.report("directory", "no kind of log is to be written (expected glf, mcap or pcapng to be true)");
  }
  std::uint64_t mebibytes = recording.rotate_bytes >> 20;
  section.integer("rotate_mib", mebibytes, 1, 1800,  // a .glf holds 1907 MiB, and a ping may still come
                  "when one of the files has so many mebibytes, all are closed, and new ones begun");
  recording.rotate_bytes = mebibytes << 20;
  section.duration("rotate_min", recording.rotate_after, Range::from(0.05, 10'080.0),
                   "and so they are after so many minutes");
  section.choice("zone", recording.zone, {{"utc", RecordingZone::utc}, {"local", RecordingZone::local}},
                 "clock of the times in a `.glf` and of all names; a `.glf` does not say which it is");
  section.choice("sync", recording.sync,
                 {{"never", RecordingSync::never},
                  {"on_close", RecordingSync::on_close},
                  {"every_second", RecordingSync::every_second}},
                 "when files are forced onto the disk, against power cuts; a process that is killed loses "
                 "nothing by any of them");
  mebibytes = recording.queue_bytes >> 20;
  section.integer(
      "queue_mib", mebibytes, 1, 16'384,
      "what waits to be written; beyond that is dropped and counted, for nothing ever waits for the disk");
  recording.queue_bytes = mebibytes << 20;
  section.duration(
      "stop_deadline_s", recording.stop_deadline, Range::from(0.0, 3600.0),
      "when the daemon ends, it waits no longer than this for the disk; it then logs what is not "
      "on the disk, and the next start repairs the logs");
}

void read_web(YamlSection& section, WebConfig& web) {
  section.introduce(
      "A page in the browser that shows each head's pictures, the world, poses and what is wrong "
      "([page.md](page.md)), and what monitors ask: `/health`, `/ready`, `/metrics`, `/api/status`.");
  read_socket(section, web.bind, web.allow, endpoint_form, "the demo uses 127.0.0.1:8014",
              "who may look; all may see what all see");
  section.text("token", web.token,
               "whoever sends it may also change state, as turning the recording on and off does; browsers "
               "of this machine may without");
  section.default_is("token", "none: nobody from elsewhere may");
  constexpr TextForm origins{"an origin such as https://example.org", "origins", R"("type": "string")"};
  section.parsed_list("origins", web.origins, &any_text, origins,
                      "other sites whose pages may connect from a browser; the page's own always may");
  section.integer(
      "max_viewers", web.max_viewers, 1, 1000,
      "WebSockets at a time; further ones are refused with status 503. Monitors always get a place");
  section.integer(
      "max_viewers_per_peer", web.max_viewers_per_peer, 1, 1000,
      "WebSockets of one address at a time. A tab of the page has one. Programs behind one gateway "
      "or proxy, such as Docker's, share its address");
}

void read_document(YamlSection& root, std::span<const HeadKind* const> kinds, DaemonConfig& config) {
  HeadContext context;
  context.folder = config.file.parent_path();
  root.section("log", "the log",
               [&](YamlSection& section) { read_log(section, config.log_level, config.log_format); });
  root.require("world", "a mapping with the world's file, or `empty` for open water");
  const std::string_view word = root.word("world");
  const bool is_open_water = word == "empty";
  if (is_open_water || root.describing()) {
    root.choice("world", config.open_water, {{"empty", true}}, "what the sonars see; `empty` is open water");
  }
  if (!is_open_water && !word.empty()) {
    root.report("world", fmt::format("is {} (expected a mapping such as {{file: sea.sdf}}, or empty for "
                                     "open water)",
                                     in_quotes(word)));
  } else if (!is_open_water) {
    root.section("world", "what the sonars see; `empty` is open water",
                 [&](YamlSection& section) { read_world(section, context.folder, config); });
  }
  root.choice(
      "engine", config.engine,
      {{"auto", render::EngineKind::automatic},
       {"gpu", render::EngineKind::gpu},
       {"cpu", render::EngineKind::cpu}},
      "what renders: OpenGL 4.5 on the graphics card, or the cores of the CPU, which needs no OpenGL. "
      "`auto` renders the first ping of each head with both and takes the faster; the log gives both "
      "times. If OpenGL runs in software, `auto` takes the CPU at once. Where a GPU fails while it serves, "
      "the CPU goes on with the same ping. The images agree "
      "within the error of the preset ([accuracy.md](accuracy.md))");
  root.section("gpu", "what engine `gpu` runs on",
               [&](YamlSection& section) { read_gpu(section, config.gpu); });
  if (config.engine == render::EngineKind::cpu) {
    root.warn_if_given("gpu", "the engine is `cpu`");
  }
  root.retired("backend", "write `engine: gpu` for raster, `engine: cpu` for ray, `engine: auto` for auto");
  root.retired("gpu_binning", "remove it; engine `gpu` bins on the GPU in any case");
  root.section("skip", "what need not be worked out",
               [&](YamlSection& section) { read_skip(section, config.skip); });
  root.section("water", "what they swim in", [&](YamlSection& section) { read_water(section, context); });
  context.water.sound_speed_mps = render::sound_speed_mps(properties(context.water));
  config.water = context.water;
  root.require("poses", "a mapping that says where poses come from");
  root.section("poses", "where the vehicle is",
               [&](YamlSection& section) { read_poses(section, context.folder, config.poses); });
  context.pings_by_source = config.poses.clock != PingClock::wall;
  root.section("sampling", "the error that is aimed at", [&](YamlSection& section) {
    read_sampling(section, context.sampling, context.adaptive_quality);
    if (context.pings_by_source && context.adaptive_quality) {
      section.warn_if_given("adaptive_quality", "pings keep the time of the poses (`poses.clock`)");
    }
  });
  root.section(
      "recording", "logs of what the heads say; without it there are none",
      [&](YamlSection& section) { read_recording(section, context.folder, config.recording.emplace()); });
  root.section("web", "a page to watch on, and metrics; without it there is none",
               [&](YamlSection& section) { read_web(section, config.web.emplace()); });
  root.require("heads", "a list of sonar heads");
  root.sections("heads", "the sonars, one or more",
                [&](YamlSection& section) { config.heads.push_back(read_head(section, context, kinds)); });
  if (root.is_list("heads") && config.heads.empty()) {
    root.report("heads", "no head is listed (expected at least one)");
  }
}

}  // namespace

namespace {

void name_sections(YamlFindings& findings, std::span<const HeadKind* const> kinds) {
  if (findings.unknown_keys.empty()) {
    return;
  }
  std::vector<std::vector<KeyReference>> known;
  known.reserve(kinds.size());
  for (const HeadKind* const kind : kinds) {
    known.push_back(describe_config(*kind));
  }
  name_sections(findings.problems, findings.unknown_keys, known);
}

}  // namespace

std::string read_config(const std::filesystem::path& file) {
  return read_file(file);
}

LoadedConfig load_config(const std::filesystem::path& file, std::span<const HeadKind* const> kinds) {
  return load_config(file, read_file(file), kinds);
}

LoadedConfig load_config(const std::filesystem::path& file, const std::string& text,
                         std::span<const HeadKind* const> kinds) {
  const YAML::Node document = parse_yaml(file, text);
  YamlFindings findings;
  LoadedConfig loaded;
  loaded.config.file = file;
  {
    YamlSection root(findings, document, "");
    read_document(root, kinds, loaded.config);
  }
  name_sections(findings, kinds);
  if (findings.problems.empty()) {
    findings.problems = find_overlaps(loaded.config, findings.positions);
  }
  if (findings.problems_left_out > 0) {
    findings.problems.push_back({findings.problems.back().at, "",
                                 fmt::format("{} more problems are not shown", findings.problems_left_out)});
  }
  if (!findings.problems.empty()) {
    throw ConfigError(file, std::move(findings.problems));
  }
  loaded.positions = std::move(findings.positions);
  for (const ConfigWarning& warning : findings.warnings) {
    loaded.warnings.push_back(loaded.problem_at(warning.key, warning.message));
  }
  return loaded;
}

std::vector<KeyReference> describe_config(const HeadKind& kind) {
  YamlFindings findings;
  findings.describing = true;
  DaemonConfig config;
  YamlSection root(findings, YAML::Node(YAML::NodeType::Map), "");
  read_document(root, std::array{&kind}, config);
  return root.known();
}

std::string LoadedConfig::problem_with(std::string_view key, const std::string& message) const {
  return problem_text(config.file, problem_at(key, message));
}

ConfigProblem LoadedConfig::problem_at(std::string_view key, const std::string& message) const {
  return {nearest_position(positions, key), std::string(key), message};
}

}  // namespace sonard::server
