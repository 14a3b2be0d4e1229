// What the daemon knows of any head.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "renderer/skip_ledger.hpp"
#include "server/clock.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::server {

class Playback;
class PoseHistory;
class Recorder;
class RenderService;

/// What a head needs of the daemon. Everything outlives the head.
struct HeadServices {
  boost::asio::io_context& io;
  const Clock& clock;
  RenderService& renderer;
  const PoseHistory& poses;
  std::optional<double> water_surface_z_m;  ///< height above which a sonar is out of the water
  render::SkipSwitches skip{};              ///< for SkipRule::nobody_listening
  Playback* playback = nullptr;             ///< for heads whose DeviceConfig::plays_back is set
  Recorder* recorder = nullptr;             ///< null: nothing is recorded
  std::string vehicle_model{};              ///< the body that moves as the vehicle does; empty: none
};

/// A device on its transport. Constructor and destructor belong to the thread that owns the io_context while
/// nobody runs it; everything else to the I/O thread. At most one render job is outstanding.
///
/// Shutdown: stop() closes the transport and cancels the timers. Handlers that are still queued, and an image
/// still being rendered, find the inner state stopped or gone and do nothing.
class Head {
 public:
  Head() = default;
  virtual ~Head() = default;
  Head(const Head&) = delete;
  Head& operator=(const Head&) = delete;

  virtual void start() = 0;
  virtual void stop() = 0;

  /// PoseHistory has one more: a ping by the clock of the source may have waited for it.
  virtual void poses_changed() = 0;
  /// See PingTimes::spare().
  virtual std::optional<std::chrono::nanoseconds> spare_poses() const = 0;
};

}  // namespace sonard::server
