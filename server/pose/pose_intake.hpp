// SPDX-License-Identifier: Apache-2.0
// The way of poses from their sources into the history, and to the pings that wait for them.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <optional>

#include <boost/asio/steady_timer.hpp>

#include "server/pose/pose_history.hpp"
#include "server/pose/pose_source.hpp"

namespace sonard::server {

/// Belongs to the I/O thread.
///
/// In lock-step two things wait for the pings that the poses so far allow: a clock that is set back, which
/// would take these poses away, with all that comes after it; and publishers that can wait, when the poses
/// are too far ahead. By any other clock poses pass at once.
class PoseIntake {
 public:
  struct Hooks {
    std::function<void()> changed;  ///< the history has one more
    /// By how much the poses there are exceed what the head needs that is furthest behind, for its next ping;
    /// negative: all heads wait for poses. nullopt: no pings are wanted.
    std::function<std::optional<std::chrono::nanoseconds>()> lead;
  };
  /// `poses` outlives it.
  PoseIntake(boost::asio::io_context& io, PoseHistory& poses, Hooks hooks);

  void take(const pose::PoseSample& sample, TimePoint arrival);
  /// Publishers that can wait are to wait.
  bool hold() const;
  void stop();

  static constexpr std::chrono::milliseconds most_ahead{500};
  /// Poses of a new life of the clock that may wait for the end of the last one; what comes beyond is lost.
  static constexpr std::size_t most_waiting = 65'536;

 private:
  struct Arrived {
    pose::PoseSample sample;
    TimePoint arrival{};
  };

  bool pings_to_come() const;
  void insert(const pose::PoseSample& sample, TimePoint arrival);
  void insert_waiting();
  void look_again();

  PoseHistory& poses_;
  Hooks hooks_;
  boost::asio::steady_timer timer_;
  std::deque<Arrived> waiting_;
  std::uint64_t lost_ = 0;
};

}  // namespace sonard::server
