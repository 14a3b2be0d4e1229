// SPDX-License-Identifier: Apache-2.0
// One head of the daemon: a device on its transport, whose pings are rendered or played back, and recorded.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/skip_ledger.hpp"
#include "server/clock/clock.hpp"
#include "server/config/config.hpp"

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

/// What a head needs of the daemon. Everything outlives the head.
struct HeadServices {
  boost::asio::io_context& io;
  const Clock& clock;
  RenderService& renderer;
  const PoseHistory& poses;
  std::optional<double> water_surface_z_m;  ///< height above which a sonar is out of the water
  render::SkipSwitches skip{};              ///< for SkipRule::nobody_listening
  Playback* playback = nullptr;             ///< null: pings are rendered
  Recorder* recorder = nullptr;             ///< null: nothing is recorded
  std::string vehicle_model{};              ///< the body that moves as the vehicle does; empty: none
  PingViewer* viewer = nullptr;             ///< null: nobody can watch
  const render::World* world = nullptr;     ///< where the head looks around; null: it does not
};

/// Passes events to Device::step() and carries out its actions, for every kind of device alike. While the
/// transport is blocked events wait, so that a device does not send faster than the transport does.
///
/// Constructor and destructor belong to the thread that owns the io_context while it does not run; everything
/// else to the I/O thread. At most one render job is outstanding.
///
/// Shutdown: stop() closes the transport and cancels the timers. Handlers that are still queued, and an image
/// still being rendered, find the inner state stopped or gone and do nothing.
class Head {
 public:
  /// @throws SocketError
  Head(const HeadConfig& config, int stream, const HeadServices& services);
  ~Head();
  Head(const Head&) = delete;
  Head& operator=(const Head&) = delete;

  void start();
  void stop();

  /// PoseHistory has one more: a ping by the clock of the source may have waited for it.
  void poses_changed();
  /// See PingTimes::lead().
  std::optional<std::chrono::nanoseconds> pose_lead() const;

  /// Follows the address of its interface, and tells of one that is gone.
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
