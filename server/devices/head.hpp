// SPDX-License-Identifier: Apache-2.0
// One head of the daemon: a device on its transport. Its pings are rendered or played back, and recorded.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/skip_ledger.hpp"
#include "server/clock/clock.hpp"
#include "server/heads/head_config.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::render {
struct World;
}

namespace sonard::server {

class ConnectedDevice;
class PingViewer;
class Playback;
class PoseHistory;
class Recorder;
class RenderService;
struct HeadStatus;
struct InterfaceAddress;
struct RenderCounters;

/// Services of the daemon, from which a head gives each of its parts what the part needs. They outlive the
/// head.
struct HeadServices {
  boost::asio::io_context& io;
  const Clock& clock;
  RenderService& renderer;
  const PoseHistory& poses;
  std::optional<double> water_surface_z_m;  ///< height in the world frame; nullopt: there is no surface
  render::SkipSwitches skip{};              ///< for SkipRule::nobody_listening
  Playback* playback = nullptr;             ///< null: pings are rendered
  Recorder* recorder = nullptr;             ///< null: nothing is recorded
  std::string vehicle_model{};              ///< the body that moves with the vehicle; empty: no body does
  PingViewer* viewer = nullptr;             ///< null: no page
  const render::World* world = nullptr;     ///< for diagnosis; null: no diagnosis
};

/// Passes events to Device::step() and carries out its actions, the same way for every type of device. While
/// the transport is blocked, events wait, so that a device does not send faster than the transport.
///
/// Belongs to the I/O thread. The thread that owns the io_context constructs and destroys it while the
/// context does not run. At most one render job is outstanding.
///
/// Shutdown: stop() closes the transport and cancels the timers. Queued handlers, and an image still being
/// rendered, find the inner state stopped or gone and do nothing.
class Head {
 public:
  /// @throws SocketError
  Head(const HeadConfig& config, int index, const HeadServices& services);
  ~Head();
  Head(const Head&) = delete;
  Head& operator=(const Head&) = delete;

  void start();
  void stop();

  /// Called when PoseHistory has a new pose: in simulated time a ping may have waited for it.
  void poses_changed();
  /// See SimulatedPingTimes::lead().
  std::optional<std::chrono::nanoseconds> pose_lead() const;

  /// Follows the address of its interface, and logs if an address is gone.
  /// @param now interface_addresses()
  void look_at_addresses(const std::vector<InterfaceAddress>& now);

  HeadStatus status() const;
  ConnectedDevice& connected();
  const RenderCounters& render_counters() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
