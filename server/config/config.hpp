// The whole configuration of the daemon as plain values: SI units, radians, parsed addresses, paths that
// are resolved against the folder of the configuration file.
// server/config/loader.hpp makes it from YAML; everything else of the server only reads it.
// docs/configuration.md lists the keys with their units and defaults.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "protocol/gemini/device_config.hpp"
#include "protocol/micron/device_config.hpp"
#include "protocol/pose/pose_codec.hpp"
#include "renderer/backend.hpp"
#include "renderer/pose.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::server {

/// IPv4 address, first octet most significant (127.0.0.1 = 0x7F000001).
using Ipv4 = std::uint32_t;

/// Where a datagram goes to, or what a socket is bound to.
struct Endpoint {
  Ipv4 address = 0;        ///< 0 binds all addresses
  std::uint16_t port = 0;  ///< 0 lets the kernel choose (bind only)

  bool operator==(const Endpoint&) const = default;
};

/// Block of addresses, "127.0.0.0/8".
struct Cidr {
  Ipv4 network = 0;        ///< host bits are zero
  int prefix_length = 32;  ///< 0..32

  bool contains(Ipv4 address) const;
  bool operator==(const Cidr&) const = default;
};

/// Whom a socket listens to. A datagram or connection from elsewhere is counted and dropped.
using AllowList = std::vector<Cidr>;

/// True when one of the blocks contains the address; an empty list allows nobody.
bool allows(const AllowList& list, Ipv4 address);

enum class LogLevel { trace, debug, info, warn, error };

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
};

/// A UDP socket that listens to a MAVLink vehicle (docs/simulators/ardusub.md).
struct MavlinkPoseInput {
  Endpoint bind;
  AllowList allow;
  std::uint8_t system_id = 1;     ///< the vehicle, 1..255
  std::uint8_t component_id = 1;  ///< the part of it that is believed, 1..255; 1: the autopilot
  MavlinkMessages messages = MavlinkMessages::automatic;
  render::Pose T_world_local;  ///< where the origin of its positions is, in axes east, north, up
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
struct IgnitionPoseInput {
  struct Body {
    SimulatorEntity entity;
    std::string body;  ///< of our world
  };
  std::string topic;
  std::string partition;          ///< empty: that of IGN_PARTITION
  SimulatorEntity vehicle;        ///< carrier of the sonars; without a name: DaemonConfig::vehicle_model
  render::Pose T_entity_vehicle;  ///< mount of the vehicle frame on that entity
  std::vector<Body> bodies;
};

/// What a head does when the newest pose is older than the extrapolation limit.
enum class StalePolicy {
  hold,     ///< goes on pinging from the last pose
  silence,  ///< sends status packets only, until a pose arrives
};

/// What time it is for the pings.
enum class PingClock {
  wall,       ///< the time of this machine
  source,     ///< that of the stamps of the poses; a ping that would come too late to keep up is left out
  lock_step,  ///< the same, but every ping is made, however long it takes: publishers by TCP have to wait
};

struct PoseConfig {
  /// T_world_vehicle that holds until the first pose arrives; without it the heads answer but do not ping.
  std::optional<render::Pose> T_world_vehicle_initial;
  std::optional<UdpPoseInput> udp;
  std::optional<TcpPoseInput> tcp;
  std::optional<MavlinkPoseInput> mavlink;
  std::optional<TrajectoryInput> trajectory;
  std::optional<IgnitionPoseInput> ignition;
  /// Past the newest pose the twist is followed this long (without a twist the pose is held); >= 0.
  std::chrono::nanoseconds extrapolation_limit{std::chrono::milliseconds{500}};
  StalePolicy stale_policy = StalePolicy::hold;
  PingClock clock = PingClock::wall;
};

/// Where the 1 Hz status packets go.
struct StatusDestination {
  enum class Mode {
    limited_broadcast,   ///< 255.255.255.255, as the device does
    directed_broadcast,  ///< the broadcast address of the alternate address under its netmask
    unicast,             ///< each of `hosts`
  };
  Mode mode = Mode::limited_broadcast;
  std::vector<Ipv4> hosts;  ///< for `unicast` only, then not empty
};

/// Faults put on datagrams of one direction, each drawn anew for each datagram.
struct LinkFaults {
  double loss = 0.0;                   ///< probability, [0, 1]
  double duplicate = 0.0;              ///< probability that a second copy goes too, [0, 1]
  double reorder = 0.0;                ///< probability to be held back behind the next datagram, [0, 1]
  std::chrono::nanoseconds delay{0};   ///< added to each datagram, >= 0
  std::chrono::nanoseconds jitter{0};  ///< plus a uniform draw from [0, jitter], >= 0

  /// True when every datagram passes at once and unchanged.
  bool transparent() const {
    return loss == 0.0 && duplicate == 0.0 && reorder == 0.0 && delay.count() == 0 && jitter.count() == 0;
  }
};

/// Faults of the link between a head and its surface, to test drivers with. Seeded: the same datagrams in
/// the same order meet the same fate.
struct LinkConfig {
  LinkFaults to_surface;
  LinkFaults from_surface;
  std::uint64_t seed = 1;
};

/// A TCP listener that gives a serial line's raw bytes to each client, as serial device servers do.
struct SerialTcpConfig {
  Endpoint bind;
  AllowList allow;
};

/// A UDP socket that carries a serial line: a datagram for each write of either side.
struct SerialUdpConfig {
  Endpoint bind;
  AllowList allow;
};

/// A pseudo terminal, whose slave is a serial device to whoever opens it.
struct SerialPtyConfig {
  /// Symbolic link to the slave, whose own name is new at each start; empty: none.
  std::filesystem::path link;
};

/// Every way at once by which the clients of a serial device reach it.
struct SerialLinkConfig {
  std::vector<SerialTcpConfig> tcp;
  std::vector<SerialUdpConfig> udp;
  std::vector<SerialPtyConfig> pty;
  int baud = 0;  ///< bits per second of the line, ten to a byte; 0: bytes pass as fast as they go
};

/// What all heads have.
struct HeadConfig {
  std::string name;              ///< unique in the daemon; appears in every log line of this head
  render::Pose T_vehicle_sonar;  ///< mount
  /// The sonar of the world that the mount is to be taken from (take_from_world() does); empty: none.
  std::string mount_from_world;
  bool hides_vehicle = false;  ///< whether DaemonConfig::vehicle_model is not in its images
  /// Everything of a ping that the device does not say by itself.
  render::SonarSettings acoustics;
  std::uint64_t seed = 1;  ///< of speckle and noise
  /// Folder that receives the samples of every ping as the renderer handed them over, for tests and
  /// debugging.
  std::optional<std::filesystem::path> dump_directory;
};

/// One Gemini 720i. The sonar's x axis is the acoustic axis, so a down tilt is in the mount. Its bearing
/// table and the ping job fill in `aperture.beam_edges_rad` and `range` of the acoustics.
struct GeminiHeadConfig : HeadConfig {
  GeminiHeadConfig();

  /// Identity, addresses and timing. `water_sound_speed_mps` is already chosen (0: follow the ping
  /// configuration).
  gemini::DeviceConfig device;
  /// Whether beams point elsewhere in water of another sound speed than the head assumes, as those of a flat
  /// array do (docs/physics.md 2.12).
  bool steering_error = false;
  /// Address of the command socket: one of this machine, or 0 for all of them.
  Ipv4 bind_address = 0x7F000002;
  std::uint16_t command_port = 52901;  ///< the head listens here and sends from here
  std::uint16_t surface_port = 52900;  ///< every reply goes to this port of the surface
  StatusDestination status;
  AllowList allow;  ///< surfaces that are served; status packets are not affected

  LinkConfig link;
  /// A UDP socket whose every datagram counts as one edge of the external trigger (run mode 2).
  std::optional<Endpoint> trigger;
};

/// One Micron. The head turns about the z axis of its mount, and looks along x where it says "ahead". Its
/// jobs fill in `range` of the acoustics.
struct MicronHeadConfig : HeadConfig {
  MicronHeadConfig();

  micron::DeviceConfig device;
  SerialLinkConfig serial;
  double nominal_gain_db = 36.0;  ///< of the client's, at which the level is that of the acoustics; [0, 80]
  double chirp_bandwidth_hz = 100'000.0;  ///< sets the range cell; 0: a pulse without length
};

using AnyHeadConfig = std::variant<GeminiHeadConfig, MicronHeadConfig>;

inline const HeadConfig& common(const AnyHeadConfig& head) {
  return std::visit([](const HeadConfig& any) -> const HeadConfig& { return any; }, head);
}

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
  bool glf = true;                  ///< Geminis only
  bool mcap = true;
  bool pcapng = true;
  std::uint64_t rotate_bytes = std::uint64_t{512} << 20;  ///< a file of this size or more ends all files
  std::chrono::nanoseconds rotate_after{std::chrono::hours{1}};  ///< > 0; and so does this time
  RecordingZone zone = RecordingZone::utc;
  RecordingSync sync = RecordingSync::on_close;
  std::size_t queue_bytes = std::size_t{128} << 20;  ///< what does not fit is dropped
};

struct DaemonConfig {
  std::filesystem::path file;  ///< the configuration file itself
  LogLevel log_level = LogLevel::info;
  std::filesystem::path world_file;  ///< SDF
  /// The body of the world that is the vehicle itself and moves with it; empty: none, or the one that carries
  /// the sonars that heads are mounted from (take_from_world() fills it in).
  std::string vehicle_model;
  render::Backend backend = render::Backend::automatic;
  render::GpuBinning gpu_binning = render::GpuBinning::automatic;
  render::SkipSwitches skip;  ///< what may be left out (docs/skipping.md)
  WaterConfig water;
  PoseConfig poses;
  std::vector<AnyHeadConfig> heads;  ///< at least one
  std::optional<RecordingConfig> recording;
};

}  // namespace sonard::server
