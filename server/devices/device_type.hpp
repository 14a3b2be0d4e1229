// SPDX-License-Identifier: Apache-2.0
// The server's interface to a type of device. Each type has its own folder below this one.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/common/device.hpp"
#include "renderer/ping.hpp"
#include "renderer/pose.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/clock/clock.hpp"
#include "server/devices/survey.hpp"
#include "server/heads/device_settings.hpp"
#include "server/heads/head_type.hpp"
#include "server/logs/log_reader.hpp"
#include "server/net/interfaces.hpp"
#include "server/net/transport.hpp"
#include "server/net/udp_endpoint.hpp"
#include "server/recording/log_writer.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::server {

/// A device joined with its transport, run by a Head. Belongs to the I/O thread. The thread that owns the
/// io_context constructs and destroys it while the context does not run.
class ConnectedDevice {
 public:
  ConnectedDevice() = default;
  virtual ~ConnectedDevice() = default;
  ConnectedDevice(const ConnectedDevice&) = delete;
  ConnectedDevice& operator=(const ConnectedDevice&) = delete;

  virtual Device& device() = 0;
  virtual Transport& transport() = 0;

  /// From now on, events that do not come from the transport are passed to `happen`.
  virtual void start(std::function<void(Event)> /*happen*/) {}
  virtual void stop() {}
  /// Called after each step, when its messages are sent; changes the transport if the device requests it.
  virtual void after_step() {}

  /// Called once a second, so that a head named by its interface can follow the interface's address.
  virtual void follow_addresses(const std::vector<InterfaceAddress>& /*now*/) {}
  /// This machine's addresses at which clients reach the device; nullopt: the addresses of
  /// HeadType::sockets().
  virtual std::optional<std::vector<Ipv4>> own_addresses() const { return std::nullopt; }
};

/// What the server knows of a type of device. A type with .glf logs is a GlfDevice, too; one with .sonar logs
/// is a PacketLogDevice; a type whose pings are recognised in captures is a CaptureReader.
class DeviceType : public HeadType {
 public:
  /// True if a ping is one beam, at the bearing of the job, or a few directions; false if it is a fan.
  virtual bool scanning() const = 0;
  /// False for a head whose one beam always looks along the axis of its mount.
  virtual bool turns() const { return scanning(); }
  /// True if the head has sensors of attitude, depth or motion: it receives SensorsRead.
  virtual bool has_sensors() const { return false; }

  /// All counters of such a device, with value 0 (docs/events.md).
  virtual std::vector<Counter> counters() const = 0;

  /// Opens the sockets. @throws SocketError
  virtual std::unique_ptr<ConnectedDevice> connect(const HeadConfig& head, boost::asio::io_context& io,
                                                   const Clock& clock) const = 0;
  /// The configuration key that a SocketError is about, except a PtyLinkError.
  virtual std::string socket_key() const = 0;

  /// A ping with the settings that clients usually request, for work before the first ping.
  virtual PingJob usual_job(const HeadConfig& head) const = 0;
  virtual render::SonarSettings sonar_settings(const PingJob& job, const HeadConfig& head) const = 0;

  // ---- Playing logs back

  /// Why such a head cannot play this log, in words; nullopt if it can.
  virtual std::optional<std::string> why_not_played(const LoggedHead& logged) const = 0;
  /// Errors that clients will see in a played log, one phrase each.
  virtual std::vector<std::string> played_wrongly(const LoggedHead& /*logged*/) const { return {}; }
  /// A head at a loopback address that plays this log.
  virtual HeadConfig on_loopback(const LoggedHead& logged, Ipv4 address) const = 0;
  /// The head's configuration, changed to keep the times of a log.
  virtual HeadConfig held_to_recording(HeadConfig head) const = 0;

  // ---- Rendering without serving

  /// The survey of such a head. @throws CLI::ValidationError naming an option that the head does not have
  virtual std::unique_ptr<Survey> survey(const HeadConfig& head, const SurveyOptions& options) const = 0;
};

/// The type of a head; every head of this program has a DeviceType.
inline const DeviceType& type_of(const HeadConfig& head) {
  return checked_cast<DeviceType>(head.type);
}

/// Where a SocketError of a head lies.
struct SocketTrouble {
  std::string key;         ///< of the head: "serial.pty[0].link"
  bool of_network = true;  ///< it may pass; false: the configuration or a folder must change
};
SocketTrouble trouble_of(const SocketError& error, const DeviceType& type);

/// Readings of a head's sensors if its mount has this pose.
/// @param water_surface_z_m height of the surface in the world frame; nullopt: the world has no surface
/// @param velocity_mps PosesUsed::sonar_velocity_mps
SensorReadings sensor_readings(const render::Pose& T_world_mount, std::optional<double> water_surface_z_m,
                               const glm::dvec3& velocity_mps = glm::dvec3{0.0});

/// Azimuth in the sonar frame, as the renderer has it, of a bearing of the device (docs/frames-and-units.md).
constexpr double azimuth_rad(double bearing_rad) {
  return -bearing_rad;
}

/// Pose of a head's transducer at a bearing (PingJob::bearing_rad): the mount, rotated about its z axis.
render::Pose T_world_transducer(const render::Pose& T_world_mount, double bearing_rad);

/// Renderer settings of DeviceType::usual_job().
render::SonarSettings usual_settings(const HeadConfig& head);
/// The ping of DeviceType::usual_job(), sent from the vehicle's pose.
render::PingRequest usual_ping(const HeadConfig& head, const render::Pose& T_world_vehicle);
/// The heads with the names that their logs use, in the order of the configuration.
std::vector<HeadToRecord> recorded_heads(const std::vector<HeadConfig>& heads);

/// @throws render::RequestError if the configured sampling cannot serve the head's usual ping
void check_sampling_of(const HeadConfig& head);

}  // namespace sonard::server
