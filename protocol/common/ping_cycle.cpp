// SPDX-License-Identifier: Apache-2.0
#include "protocol/common/ping_cycle.hpp"

#include <algorithm>
#include <chrono>

namespace sonard {

void PingCycle::reboot(TimePoint boot_time) {
  cancel();
  boot_time_ = boot_time;
}

std::optional<TimePoint> PingCycle::next_start(TimePoint wanted, TimePoint by_rate) const {
  if (busy() || (config_.plays_back && !fed_)) {
    return std::nullopt;
  }
  if (config_.simulated_time) {
    return wanted;
  }
  const TimePoint start = std::max(wanted, by_rate);
  return fed_ ? std::max(start, fed_->due.value_or(start)) : start;
}

void PingCycle::begin(PingJob job, TimePoint transmit_time) {
  granted_ = false;
  under_way_ = true;
  job_ = std::move(job);
  job_.number = next_number_++;
  job_.transmit_time = transmit_time;
  job_.transmit_us = static_cast<std::uint64_t>((transmit_time - boot_time_) / std::chrono::microseconds{1});
  if (const auto fed = std::exchange(fed_, std::nullopt)) {
    job_.record = fed->record;
  }
  job_is_new_ = true;
  unanswered_ = job_.number;
  ++counters_.pings_started;
}

/// True if the newest job awaits an answer and this is the answer.
bool PingCycle::answer(TimePoint now, std::uint64_t number) {
  if (unanswered_ != number) {
    ++counters_.stale_images;
    return false;
  }
  unanswered_.reset();
  answered_at_ = now;
  return true;
}

bool PingCycle::on_image(TimePoint now, std::uint64_t number) {
  if (!answer(now, number)) {
    return false;
  }
  counters_.stale_images += under_way_ ? 0 : 1;
  return under_way_;
}

bool PingCycle::on_image_failed(TimePoint now, std::uint64_t number) {
  if (!answer(now, number) || !under_way_) {
    return false;
  }
  fail();
  return true;
}

void PingCycle::put_on_wire(PingRecord record) {
  record_ = std::move(record);
  record_->number = job_.number;
  record_->transmit_time = job_.transmit_time;
  under_way_ = false;
}

void PingCycle::fail() {
  ++counters_.pings_failed;
  under_way_ = false;
}

void PingCycle::cancel() {
  counters_.pings_cancelled += under_way_ ? 1 : 0;
  under_way_ = false;
}

void PingCycle::report(Actions& actions) {
  if (std::exchange(job_is_new_, false)) {
    actions.render = job_;
  }
  actions.record = std::exchange(record_, std::nullopt);
  actions.cancelled = under_way_ ? std::nullopt : unanswered_;
}

}  // namespace sonard
