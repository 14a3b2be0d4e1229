// SPDX-License-Identifier: Apache-2.0
// Passes poses from their sources to the history, and to the pings that wait for them.
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
/// In lock-step, two things wait for the pings that the received poses allow. If a clock is set back, its
/// poses wait, because they would drop the earlier poses. If the poses are too far ahead, publishers wait if
/// they can. With other clocks, poses pass at once.
class PoseIntake {
 public:
  struct Hooks {
    std::function<void()> changed;  ///< called when the history has a new pose
    /// By how much the newest pose exceeds the need of the slowest head for its next ping. Negative: all
    /// heads wait for poses. nullopt: no pings are requested.
    std::function<std::optional<std::chrono::nanoseconds>()> lead;
  };
  /// `poses` must outlive this object.
  PoseIntake(boost::asio::io_context& io, PoseHistory& poses, Hooks hooks);

  void take(const pose::PoseSample& sample, TimePoint arrival);
  /// True if publishers must wait, if they can.
  bool hold() const;
  void stop();

  static constexpr std::chrono::milliseconds most_ahead{500};
  /// Limit of the poses after a clock restart that wait for the last pings before it; further poses are lost.
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
