// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/common/head_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>

#include "common/text/printable.hpp"

namespace sonard::client {
namespace {

using std::chrono::nanoseconds;

constexpr nanoseconds progress_period = std::chrono::seconds{1};

}  // namespace

TimePoint steady_now() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

double in_seconds(nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

HeadRun::HeadRun(const RunOptions& options, const std::filesystem::path& out, std::string says)
    : options_(options), says_(std::move(says)) {
  if (!out.empty()) {
    writer_.emplace(out);
  }
}

void HeadRun::meet(TimePoint at) {
  met_at_ = waiting_since_ = at;
  progress_due_ = at + progress_period;
}

void HeadRun::count_ping(TimePoint received) {
  if (counters_.pings++ == 0) {
    first_ping_at_ = received;
  }
  last_ping_at_ = waiting_since_ = received;
}

std::optional<std::uint64_t> HeadRun::fresh_pings(TimePoint at) {
  if (!met_at_ || at < progress_due_) {
    return std::nullopt;
  }
  progress_due_ = at + progress_period;
  return counters_.pings - std::exchange(pings_at_progress_, counters_.pings);
}

HeadRun::Limit HeadRun::limit(TimePoint at, bool listens) const {
  const auto over = [at](TimePoint since, nanoseconds limit) {
    return limit.count() > 0 && at - since >= limit;
  };
  if (met_at_ && over(*met_at_, options_.duration)) {
    return Limit::duration;
  }
  if (listens && over(waiting_since_, met_at_ ? options_.ping_wait : options_.wait)) {
    return met_at_ ? Limit::no_ping : Limit::no_head;
  }
  return Limit::none;
}

TimePoint HeadRun::next_wake(bool listens) const {
  TimePoint wake = TimePoint::max();
  const auto at_limit = [&wake](TimePoint since, nanoseconds limit) {
    wake = limit.count() > 0 ? std::min(wake, since + limit) : wake;
  };
  if (met_at_) {
    wake = progress_due_;
    at_limit(*met_at_, options_.duration);
  }
  if (listens) {
    at_limit(waiting_since_, met_at_ ? options_.ping_wait : options_.wait);
  }
  return wake;
}

void HeadRun::say(const std::string& message) const {
  if (!options_.quiet) {
    warn(message);
  }
}

void HeadRun::warn(const std::string& message) const {
  fmt::print(stderr, "{}{}\n", says_, printable(message));
}

void HeadRun::fail(ExitStatus failure, const std::string& message) {
  warn(message);
  failure_ = failure_.value_or(failure);
}

void HeadRun::finish() {
  if (writer_) {
    writer_->finish();
    counters_.images_written = writer_->written();
    counters_.images_skipped = writer_->skipped();
    if (!writer_->error().empty()) {
      fail(ExitStatus::system, writer_->error());
    }
  }
  if (const double span_s = in_seconds(last_ping_at_ - first_ping_at_); span_s > 0.0) {
    counters_.rate_hz = static_cast<double>(counters_.pings - 1) / span_s;
  }
}

ExitStatus HeadRun::status(bool all_arrived) const {
  return failure_.value_or(all_arrived ? ExitStatus::ok : ExitStatus::incomplete);
}

}  // namespace sonard::client
