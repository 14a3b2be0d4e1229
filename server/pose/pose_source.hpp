// SPDX-License-Identifier: Apache-2.0
// Something that delivers poses to the daemon.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "protocol/pose/pose_codec.hpp"
#include "server/clock/clock.hpp"
#include "server/config/config.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::server {

/// The OS refused a socket. what() is one line naming source, address, operation and reason.
struct PoseSourceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Takes each pose and the time of its arrival. Called on the I/O thread.
using PoseSink = std::function<void(const pose::PoseSample&, TimePoint arrival)>;

/// True while publishers that can wait are to wait: the pings are behind. Asked on the I/O thread.
using PoseHold = std::function<bool()>;

/// Counters, which only grow.
struct PoseSourceCounters {
  std::uint64_t samples = 0;    ///< delivered
  std::uint64_t malformed = 0;  ///< messages that are no pose message, and lengths that are none
  std::uint64_t bad_value = 0;  ///< pose messages with a value that means nothing (NaN, no rotation, ...)
  std::uint64_t refused = 0;    ///< datagrams or connections from peers that are not allowed, or are too many
  std::uint64_t connections = 0;
  std::uint64_t closed = 0;  ///< connections closed because the peer was at fault
};

/// Belongs to the I/O thread: every member function is called there, or before the thread runs.
///
/// Shutdown: stop() closes the sockets and cancels the timers. Handlers that are already queued still run on
/// the io_context, find the source stopped and do nothing; they share ownership of the inner state, so the
/// source may be destroyed before they run. The sink is not called after stop(), which may be called from
/// within the sink.
class PoseSource {
 public:
  virtual ~PoseSource() = default;

  /// Begins to deliver. Called once.
  /// @throws PoseSourceError
  virtual void start() = 0;
  virtual void stop() = 0;
  /// "pose stream udp 127.0.0.1:14600"; with the port that the kernel chose, once started.
  virtual std::string description() const = 0;
  virtual const PoseSourceCounters& counters() const = 0;
  /// More that a source counts, " name=number" each, for the log when it ends.
  virtual std::string details() const { return {}; }
  /// Who gave the newest pose: "from 127.0.0.1:41234"; empty while there is none, and where it is known
  /// anyway.
  virtual std::string received() const { return {}; }
  /// What a simulator names, whether or not it has a part here: the first 256 names that came.
  virtual std::vector<std::string> entities() const { return {}; }
  /// What the publisher calls the stamp of a pose.
  virtual std::string stamp_name() const { return "time_ns"; }
  /// What is wrong with the newest pose, in whole sentences; empty: nothing is known to be.
  virtual std::string remark() const { return {}; }
  /// What to look at when nothing at all has arrived, in one line.
  virtual std::string silence_hint() const {
    return "is the publisher running, does it send to this address and port, and is no firewall between?";
  }
};

/// One source per input that is configured; `sink_of_next` is asked for the sink of each. `clock` and `io`
/// outlive them.
/// @throws pose::TrajectoryError when the trajectory cannot be used; PoseSourceError when this program was
/// built without Gazebo Transport, and the configuration asks for it
std::vector<std::unique_ptr<PoseSource>> make_pose_sources(boost::asio::io_context& io,
                                                           const PoseConfig& config, const Clock& clock,
                                                           const std::function<PoseSink()>& sink_of_next,
                                                           const PoseHold& hold);

}  // namespace sonard::server
