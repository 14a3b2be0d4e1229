// SPDX-License-Identifier: Apache-2.0
// The whole configuration of the daemon as plain values: SI units, radians, parsed addresses, paths that
// are resolved against the folder of the configuration file.
// server/config/loader.hpp makes it from YAML; everything else of the server only reads it.
// docs/configuration.md lists the keys with their units and defaults.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/pose/pose_codec.hpp"
#include "renderer/pose.hpp"
#include "renderer/renderer_options.hpp"
#include "renderer/scene/geographic_frame.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/net/addresses.hpp"

namespace sonard::server {

class HeadKind;

enum class LogLevel { trace, debug, info, warn, error };
enum class LogFormat { text, json };

/// What the sonars swim in. What follows from it (absorption, true speed of sound) is already in the heads'
/// settings; kept for the log and `sonard check`.
struct WaterConfig {
  double temperature_c = 10.0;
  double salinity_ppt = 35.0;
  double depth_m = 10.0;
  double ph = 8.0;
  double sound_speed_mps = 0.0;  ///< of this water (Mackenzie or Medwin), whether or not the heads use it
  /// By how much sound gets faster per metre upwards, 1/s: positive where rays sink; 0: they are straight.
  double sound_speed_gradient_per_s = 0.0;
};

/// A UDP socket that takes one pose message per datagram (docs/poses.md).
struct UdpPoseInput {
  Endpoint bind;
  AllowList allow;
};

/// A TCP listener that takes varint-delimited pose messages (docs/poses.md).
struct TcpPoseInput {
  Endpoint bind;
  AllowList allow;
  int max_clients = 8;  ///< further connections are closed at once
};

/// Which messages of a MAVLink vehicle say where it is.
enum class MavlinkMessages {
  automatic,       ///< ODOMETRY where it comes, else the others
  odometry,        ///< ODOMETRY
  local_position,  ///< LOCAL_POSITION_NED with ATTITUDE or ATTITUDE_QUATERNION
  global_position  ///< GLOBAL_POSITION_INT with the same
};

/// A UDP socket that listens to a MAVLink vehicle (docs/simulators/ardusub.md).
struct MavlinkPoseInput {
  Endpoint bind;
  AllowList allow;
  std::uint8_t system_id = 1;     ///< the vehicle, 1..255
  std::uint8_t component_id = 1;  ///< the part of it that is believed, 1..255; 1: the autopilot
  MavlinkMessages messages = MavlinkMessages::automatic;
  render::Pose T_world_local;  ///< where the origin of its positions is, in axes east, north, up
  /// Where the world is on Earth, for global_position (resolve_mounts() fills it in).
  std::optional<render::GeographicOrigin> world_origin;
};

/// A trajectory file played in real time from the start of the daemon.
struct TrajectoryInput {
  std::filesystem::path file;  ///< CSV or TUM, told apart by its content (docs/poses.md)
  bool loop = false;           ///< false: the last pose stays the newest one
  double speed = 1.0;          ///< 2: twice as fast as recorded; > 0
  pose::Axes axes = pose::Axes::enu_flu;
};

/// Something that a simulator gives the pose of, by its name there.
struct SimulatorEntity {
  std::string name;
  /// What the pose of each is relative to, from a model that stands in the world inwards; empty: the pose of
  /// the entity is in the world.
  std::vector<std::string> parents;
};

/// A topic of Gazebo (Ignition or gz transport) with poses (docs/simulators/gazebo.md).
struct GazeboPoseInput {
  struct Body {
    SimulatorEntity entity;
    std::string body;  ///< of our world
  };
  std::string topic;
  std::string partition;          ///< empty: that of IGN_PARTITION
  Ipv4 address = 0x7F000001;      ///< of this machine: of loopback, Gazebo on this machine only
  SimulatorEntity vehicle;        ///< carrier of the sonars; without a name: DaemonConfig::vehicle_model
  render::Pose T_entity_vehicle;  ///< mount of the vehicle frame on that entity
  std::vector<Body> bodies;
};

/// What a head does when the newest pose is older than the extrapolation limit.
enum class StalePolicy {
  hold,     ///< continues to ping from the last pose
  silence,  ///< sends status packets only, until a pose arrives
};

/// What time it is for the pings.
enum class PingClock {
  wall,       ///< the time of this machine
  source,     ///< that of the stamps of the poses; a ping that would come too late to keep up is left out
  lock_step,  ///< like `source`, but no ping is left out: publishers by TCP have to wait
};

struct PoseConfig {
  /// T_world_vehicle that holds until the first pose arrives; without it the heads answer but do not ping.
  std::optional<render::Pose> T_world_vehicle_initial;
  std::optional<UdpPoseInput> udp;
  std::optional<TcpPoseInput> tcp;
  std::optional<MavlinkPoseInput> mavlink;
  std::optional<TrajectoryInput> trajectory;
  std::optional<GazeboPoseInput> gazebo;
  /// Past the newest pose the twist is followed this long (without a twist the pose is held); >= 0.
  std::chrono::nanoseconds extrapolation_limit{std::chrono::milliseconds{500}};
  StalePolicy stale_policy = StalePolicy::hold;
  PingClock clock = PingClock::wall;
};

/// The part of a head's configuration that only its kind of device knows.
struct DeviceSettings {
  DeviceSettings() = default;
  virtual ~DeviceSettings() = default;
  DeviceSettings(const DeviceSettings&) = default;
  DeviceSettings& operator=(const DeviceSettings&) = default;
};

/// One head.
struct HeadConfig {
  const HeadKind* kind = nullptr;                ///< what it is; never null once it is loaded
  std::shared_ptr<const DeviceSettings> device;  ///< of that kind
  std::string name;              ///< unique in the daemon; appears in every log line of this head
  render::Pose T_vehicle_sonar;  ///< mount
  /// The sonar of the world that the mount is to be taken from (resolve_mounts() does); empty: none.
  std::string mount_from_world;
  bool hides_vehicle = false;  ///< whether DaemonConfig::vehicle_model is not in its images
  /// Everything of a ping that the device does not say by itself.
  render::SonarSettings acoustics;
  /// Whether a faster preset than the one of `acoustics` is taken while pings cannot be made as fast as they
  /// are asked for.
  bool adaptive_quality = false;
  std::uint64_t seed = 1;  ///< of speckle and noise
  /// Folder that receives the samples of every ping as the renderer handed them over, for tests and
  /// debugging.
  std::optional<std::filesystem::path> dump_directory;
};

/// The clock that names of logs and times in .glf logs show.
enum class RecordingZone { utc, local };

/// When what was written is forced onto the disk (docs/logs.md, "Recording").
enum class RecordingSync {
  never,         ///< when the kernel likes
  on_close,      ///< a file when it is closed
  every_second,  ///< that, and all open files once a second
};

/// Logs of what the heads say.
struct RecordingConfig {
  std::filesystem::path directory;  ///< made when it is not there; one daemon at a time uses it
  bool glf = true;                  ///< of heads whose users know it (HeadKind)
  bool mcap = true;
  bool mcap_wire_bytes = true;  ///< whether it has the bytes of both directions
  bool mcap_foxglove = false;   ///< whether it has pictures, places and echoes for Foxglove
  bool mcap_zstd = false;       ///< whether its chunks are compressed, when they are full
  bool pcapng = true;
  std::uint64_t rotate_bytes = std::uint64_t{512} << 20;  ///< a file of this size or more ends all files
  std::chrono::nanoseconds rotate_after{std::chrono::hours{1}};  ///< > 0; and so does this time
  RecordingZone zone = RecordingZone::utc;
  RecordingSync sync = RecordingSync::on_close;
  std::size_t queue_bytes = std::size_t{128} << 20;                 ///< what does not fit is dropped
  std::chrono::nanoseconds stop_deadline{std::chrono::seconds{5}};  ///< for what waits, when the daemon ends
};

/// The page in the browser, and what monitors ask.
struct WebConfig {
  Endpoint bind;
  AllowList allow;
  std::string token;                 ///< lets whoever knows it change state; empty: only this machine may
  std::vector<std::string> origins;  ///< other sites whose pages may connect, "https://example.org"
  int max_viewers = 128;             ///< WebSockets at a time; 1 to 1000
  int max_viewers_per_peer = 64;     ///< of them with one address; 1 to 1000
};

struct DaemonConfig {
  std::filesystem::path file;  ///< the configuration file itself
  LogLevel log_level = LogLevel::info;
  LogFormat log_format = LogFormat::text;
  std::filesystem::path world_file;  ///< SDF; empty: open water, see `open_water`
  bool open_water = false;           ///< whether the world may be without a surface
  bool skips_missing_files = false;  ///< of the world
  int world_max_triangles = 50'000'000;
  /// Where the world is on Earth, in the place of what its file says.
  std::optional<render::GeographicOrigin> origin;
  /// The body of the world that is the vehicle itself and moves with it; empty: none, or the one that carries
  /// the sonars that heads are mounted from (resolve_mounts() fills it in).
  std::string vehicle_model;
  render::EngineKind engine = render::EngineKind::automatic;
  render::GpuOptions gpu;
  render::SkipSwitches skip;  ///< what may be left out (docs/skipping.md)
  WaterConfig water;
  PoseConfig poses;
  std::vector<HeadConfig> heads;  ///< at least one
  std::optional<RecordingConfig> recording;
  std::optional<WebConfig> web;  ///< nullopt: none is served
};

}  // namespace sonard::server
