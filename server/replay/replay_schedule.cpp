// SPDX-License-Identifier: Apache-2.0
#include "server/replay/replay_schedule.hpp"

#include <algorithm>
#include <limits>

namespace sonard::server {
namespace {

using std::chrono::nanoseconds;

// Lap if all pings have the same time: a loop must advance.
constexpr std::chrono::milliseconds shortest_lap{1};

// Interval from the last ping of a lap to the first of the next.
nanoseconds usual_interval(const std::vector<nanoseconds>& offsets) {
  if (offsets.size() < 2) {
    return std::chrono::seconds{1};
  }
  std::vector<nanoseconds> intervals(offsets.size() - 1);
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    intervals[i] = offsets[i + 1] - offsets[i];
  }
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

}  // namespace

ReplaySchedule::ReplaySchedule(std::vector<std::vector<std::int64_t>> times_ns, const ReplayTiming& timing,
                               TimePoint now)
    : timing_(timing) {
  std::int64_t first_ns = std::numeric_limits<std::int64_t>::max();
  for (const auto& times : times_ns) {
    first_ns = std::min(first_ns, times.front());
  }
  for (const auto& times : times_ns) {
    Head& head = heads_.emplace_back();
    for (const std::int64_t time_ns : times) {
      head.offsets.emplace_back(time_ns - first_ns);
    }
    lap_ = std::max(lap_, head.offsets.back() + usual_interval(head.offsets));
  }
  lap_ = std::max<nanoseconds>(lap_, shortest_lap);
  if (timing_.start_now) {
    start_ = now;
  }
}

TimePoint ReplaySchedule::due(const Head& head, std::size_t ping) const {
  const std::size_t count = head.offsets.size();
  const nanoseconds offset = head.offsets[ping % count] + lap_ * static_cast<std::int64_t>(ping / count);
  return *start_ + std::chrono::duration_cast<nanoseconds>(std::chrono::duration<double, std::nano>(
                       static_cast<double>(offset.count()) / timing_.speed));
}

void ReplaySchedule::skip_missed(Head& head, TimePoint now) {
  while (has_next(head)) {
    const bool has_another = timing_.loop || head.next + 1 < head.offsets.size();
    const bool overtaken = has_another && due(head, head.next + 1) <= now;
    if (!overtaken && due(head, head.next) + most_behind >= now) {
      return;
    }
    ++head.next;
    ++skipped_;
  }
}

std::optional<ReplaySchedule::Ping> ReplaySchedule::next(std::size_t head_index, TimePoint now) {
  Head& head = heads_.at(head_index);
  if (timing_.start_now && !timing_.as_asked) {
    skip_missed(head, now);
  }
  if (!has_next(head)) {
    return std::nullopt;
  }
  Ping ping{head.next % head.offsets.size(), std::nullopt};
  if (start_ && !timing_.as_asked) {
    ping.due = due(head, head.next);
  }
  return ping;
}

void ReplaySchedule::started(std::size_t head_index, TimePoint transmit_time) {
  Head& head = heads_.at(head_index);
  if (!timing_.as_asked) {
    if (!start_) {
      start_ = transmit_time;
      *start_ -= due(head, head.next) - transmit_time;  // this ping may not be the first of all
    }
    const nanoseconds late = transmit_time - due(head, head.next);
    if (!timing_.start_now && late > most_behind) {
      *start_ += late;
    }
  }
  ++head.next;
}

bool ReplaySchedule::over(TimePoint now) {
  for (std::size_t i = 0; i < heads_.size(); ++i) {
    if (next(i, now)) {
      return false;
    }
  }
  return true;
}

}  // namespace sonard::server
