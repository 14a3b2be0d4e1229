// SPDX-License-Identifier: Apache-2.0
// Interface of a source of poses.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "protocol/pose/pose_codec.hpp"
#include "server/clock/clock.hpp"
#include "server/pose/publisher_id.hpp"

namespace sonard::server {

/// Receives each pose and the time of its arrival. Called on the I/O thread.
using PoseSink = std::function<void(const pose::PoseSample&, TimePoint arrival)>;

/// True if publishers must wait because the pings are behind. Called on the I/O thread.
using PoseHold = std::function<bool()>;

/// Counters; they only grow.
struct PoseSourceCounters {
  std::uint64_t samples = 0;    ///< delivered
  std::uint64_t malformed = 0;  ///< undecodable messages, and invalid lengths
  std::uint64_t bad_value = 0;  ///< pose messages with an invalid value (NaN, not a rotation, ...)
  std::uint64_t refused = 0;    ///< datagrams or connections from peers that are not allowed, or too many
  std::uint64_t connections = 0;
  std::uint64_t closed = 0;  ///< connections closed because the peer was at fault
};

/// The time stamp in a publisher's messages.
struct StampField {
  std::string name = "time_ns";
  std::string unit = "nanoseconds";
  double unit_s = 1e-9;  ///< its smallest step
};

/// Belongs to the I/O thread: call every member function there, or before the thread runs.
///
/// Shutdown: stop() closes the sockets and cancels the timers. Queued handlers still run on the io_context,
/// find the source stopped and do nothing. They share ownership of the inner state, so the source may be
/// destroyed before they run. The sink is not called after stop(), which may be called from within the sink.
class PoseSource {
 public:
  virtual ~PoseSource() = default;

  /// Starts to deliver poses. Called once.
  /// @throws Error
  virtual void start() = 0;
  virtual void stop() = 0;
  /// "pose stream udp 127.0.0.1:14600"; after start(), with the port that the kernel chose.
  virtual std::string description() const = 0;
  virtual const PoseSourceCounters& counters() const = 0;
  /// Further counters of the source, " name=number" each, for the log when it ends.
  virtual std::string details() const { return {}; }
  /// Publisher of the newest pose; nullopt before the first pose, and if the source does not distinguish
  /// publishers.
  virtual std::optional<PublisherId> publisher() const { return std::nullopt; }
  /// Names that a simulator sent, used or not: the first 256 that arrived.
  virtual std::vector<std::string> entities() const { return {}; }
  /// The stamp of the newest pose.
  virtual StampField stamp_field() const { return {}; }
  /// Problems with the newest pose, in whole sentences; empty if there are no known ones.
  virtual std::string remark() const { return {}; }
  /// Messages that could not be read, with the first reason, in one sentence; empty if none came lately.
  virtual std::string unreadable(TimePoint /*now*/) const { return {}; }
  /// Why no pose has arrived, in one line: "nothing arrived: is the publisher running, ..."
  virtual std::string silence_hint() const {
    return "nothing arrived: is the publisher running, does it send to this address and port, and does a "
           "firewall block it?";
  }
};

}  // namespace sonard::server
