// SPDX-License-Identifier: Apache-2.0
#include "server/pose/pose_intake.hpp"

#include <spdlog/spdlog.h>

#include <bit>
#include <utility>

namespace sonard::server {

PoseIntake::PoseIntake(boost::asio::io_context& io, PoseHistory& poses, Hooks hooks)
    : poses_(poses), hooks_(std::move(hooks)), timer_(io) {}

void PoseIntake::take(const pose::PoseSample& sample, TimePoint arrival) {
  if (waiting_.empty() && !(poses_.would_restart(sample.time_ns) && pings_to_come())) {
    insert(sample, arrival);
    return;
  }
  if (waiting_.size() == most_waiting) {
    if (std::has_single_bit(++lost_)) {
      spdlog::warn(
          "pose stream: poses dropped, because too many wait for pings from before the clock went back ({} "
          "so far)",
          lost_);
    }
    return;
  }
  waiting_.push_back({sample, arrival});
  if (waiting_.size() == 1) {
    look_again();
  }
}

bool PoseIntake::hold() const {
  if (poses_.ping_clock() != PingClock::simulated_lock_step) {
    return false;
  }
  const auto lead = hooks_.lead();
  return !waiting_.empty() || (lead && *lead > most_ahead);
}

bool PoseIntake::pings_to_come() const {
  if (poses_.ping_clock() != PingClock::simulated_lock_step) {
    return false;
  }
  const auto lead = hooks_.lead();
  return lead && lead->count() >= 0;
}

void PoseIntake::insert(const pose::PoseSample& sample, TimePoint arrival) {
  poses_.insert(sample, arrival);
  hooks_.changed();
}

// Stops at the next pose that must wait.
void PoseIntake::insert_waiting() {
  while (!waiting_.empty() && !(poses_.would_restart(waiting_.front().sample.time_ns) && pings_to_come())) {
    const Arrived next = std::move(waiting_.front());
    waiting_.pop_front();
    insert(next.sample, next.arrival);
  }
}

void PoseIntake::look_again() {
  timer_.expires_after(std::chrono::milliseconds{2});
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (error) {
      return;
    }
    insert_waiting();
    if (!waiting_.empty()) {
      look_again();
    }
  });
}

void PoseIntake::stop() {
  timer_.cancel();
  waiting_.clear();
}

}  // namespace sonard::server
