// SPDX-License-Identifier: Apache-2.0
// The whole configuration of the daemon as plain values: SI units, radians, parsed addresses, paths resolved
// against the folder of the configuration file.
// server/config/loader.hpp makes it from YAML; the rest of the server only reads it.
// docs/configuration.md lists the keys with their units and defaults.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/pose.hpp"
#include "renderer/renderer_options.hpp"
#include "renderer/scene/geographic_frame.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/net/addresses.hpp"
#include "server/pose/pose_config.hpp"

namespace sonard::server {

class HeadType;

enum class LogLevel { trace, debug, info, warn, error };
enum class LogFormat { text, json };

/// The water. Values derived from it (absorption, true speed of sound) are already in the heads' settings; it
/// is kept for the log and `sonard check`.
struct WaterConfig {
  double temperature_c = 10.0;
  double salinity_ppt = 35.0;
  double depth_m = 10.0;
  double ph = 8.0;
  double sound_speed_mps = 0.0;  ///< of this water (Mackenzie or Medwin), whether or not the heads use it
  /// Gradient of the speed of sound per metre upwards, 1/s. Positive: rays bend down; 0: rays are straight.
  double sound_speed_gradient_per_s = 0.0;
};

/// The part of a head's configuration that only its type of device reads.
struct DeviceSettings {
  DeviceSettings() = default;
  virtual ~DeviceSettings() = default;
  DeviceSettings(const DeviceSettings&) = default;
  DeviceSettings& operator=(const DeviceSettings&) = default;
};

/// One head.
/// A larger distance between the origins of a vehicle and its sonar is suspicious: vehicles are smaller.
inline constexpr double longest_arm_m = 10.0;

struct HeadConfig {
  const HeadType* type = nullptr;                ///< type of device; not null after loading
  std::shared_ptr<const DeviceSettings> device;  ///< of that type
  std::string name;              ///< unique in the daemon; appears in every log line of this head
  render::Pose T_vehicle_sonar;  ///< mount
  /// The sonar of the world that gives the mount (resolve_mounts() reads it); empty: no such sonar.
  std::string mount_from_world;
  bool hides_vehicle = false;  ///< whether its images leave out DaemonConfig::vehicle_model
  /// All values of a ping that the device itself does not set.
  render::SonarSettings acoustics;
  /// Whether a faster preset than the one of `acoustics` is used while pings cannot be made at the requested
  /// rate.
  bool adaptive_quality = false;
  std::uint64_t seed = 1;  ///< of speckle and noise
  /// Folder for the samples of every ping as the renderer returned them, for tests and debugging.
  std::optional<std::filesystem::path> dump_directory;
};

/// The clock that names of logs and times in .glf logs show.
enum class RecordingZone { utc, local };

/// When written data is forced onto the disk (docs/logs.md, "Recording").
enum class RecordingSync {
  never,         ///< when the kernel writes it
  on_close,      ///< a file when it is closed
  every_second,  ///< as on_close, and all open files once a second
};

/// Logs of what the heads send and receive.
struct RecordingConfig {
  std::filesystem::path directory;  ///< created if missing; used by one daemon at a time
  bool glf = true;                  ///< of heads whose users know it (HeadType)
  bool mcap = true;
  bool mcap_wire_bytes = true;  ///< whether it holds the bytes of both directions
  bool mcap_foxglove = false;   ///< whether it holds images, poses and echoes for Foxglove
  bool mcap_zstd = false;       ///< whether its full chunks are compressed
  bool pcapng = true;
  std::uint64_t rotate_bytes = std::uint64_t{512} << 20;  ///< if a file reaches this size, all files end
  std::chrono::nanoseconds rotate_after{std::chrono::hours{1}};  ///< > 0; all files end after this time
  RecordingZone zone = RecordingZone::utc;
  RecordingSync sync = RecordingSync::on_close;
  std::size_t queue_bytes = std::size_t{128} << 20;                 ///< further data is dropped
  std::chrono::nanoseconds stop_deadline{std::chrono::seconds{5}};  ///< for the queue at the daemon's end
};

/// The page in the browser and the metrics for monitors.
struct WebConfig {
  Endpoint bind;
  AllowList allow;
  std::string token;                 ///< clients that send it may change state; empty: only this machine may
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
  /// The world's place on Earth; replaces the place in the world file.
  std::optional<render::GeographicOrigin> origin;
  /// The body of the world that is the vehicle and moves with it. If empty: no body, or the one with the
  /// sonars that give the mounts of the heads (resolve_mounts() sets it).
  std::string vehicle_model;
  render::EngineKind engine = render::EngineKind::automatic;
  render::GpuOptions gpu;
  render::SkipSwitches skip;  ///< what the renderer may leave out (docs/skipping.md)
  WaterConfig water;
  PoseConfig poses;
  std::vector<HeadConfig> heads;  ///< at least one
  std::optional<RecordingConfig> recording;
  std::optional<WebConfig> web;  ///< nullopt: no page
};

}  // namespace sonard::server
