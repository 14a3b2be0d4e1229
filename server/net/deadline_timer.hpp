// SPDX-License-Identifier: Apache-2.0
// One timer that always waits for the next deadline.
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "server/clock/clock.hpp"

namespace sonard::server {

/// Belongs to the I/O thread, where `due` is called at the deadline. `due` must be valid if its owner is gone
/// (use a weak pointer), because a call may already be queued when the timer is cancelled or destroyed.
class DeadlineTimer {
 public:
  explicit DeadlineTimer(boost::asio::io_context& io) : timer_(io) {}

  /// Sets the next deadline and callback; no effect if the deadline is the same. nullopt: no deadline.
  void set(const std::optional<TimePoint>& deadline, std::function<void()> due) {
    if (deadline == deadline_) {
      return;
    }
    cancel();
    deadline_ = deadline;
    if (deadline) {
      timer_.expires_at(to_steady(*deadline));
      timer_.async_wait([due = std::move(due)](const boost::system::error_code& error) {
        if (!error) {
          due();
        }
      });
    }
  }
  /// The callback must call this first: the deadline has passed.
  void passed() { deadline_.reset(); }
  void cancel() {
    deadline_.reset();
    timer_.cancel();
  }

 private:
  boost::asio::steady_timer timer_;
  std::optional<TimePoint> deadline_;
};

}  // namespace sonard::server
