// SPDX-License-Identifier: Apache-2.0
#include "server/diagnosis/pose_stream.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/text/counted.hpp"

namespace sonard::server {
namespace {

// Enough to measure a clock's rate. Poses that waited while the daemon started arrive all at once.
constexpr std::uint64_t enough_poses = 20, few_poses = 5;
constexpr double short_run_s = 1.0, long_run_s = 2.0;
constexpr double least_time_rate = 0.001;        // stamps that advance more slowly bring no ping
constexpr std::chrono::minutes worth_saying{1};  // a clock that went back once is reported for so long

struct Unit {
  std::string_view name;
  double unit_s;
};
constexpr double shortest_run_s = 1e-3;  ///< stamps of all poses that span less are not times
constexpr std::array units{Unit{"nanoseconds", 1e-9}, Unit{"microseconds", 1e-6}, Unit{"milliseconds", 1e-3},
                           Unit{"seconds", 1.0}};

/// What to do about stamps.
std::string advice(const StampField& field) {
  return fmt::format("Send the time of each pose as {}, in {}.", field.name, field.unit);
}

bool shows_rate(const PoseStatistics::Summary& summary) {
  const auto poses = static_cast<double>(summary.poses);
  return (summary.poses >= enough_poses && poses >= short_run_s * summary.rate_hz) ||
         (summary.poses >= few_poses && poses >= long_run_s * summary.rate_hz);
}

/// Finds stamps in another unit, by their rate.
std::optional<Finding> look_at_unit(const PoseStatistics::Summary& summary, const StampField& field) {
  if (!shows_rate(summary) || summary.time_rate.value_or(0.0) <= 0.0) {
    return std::nullopt;
  }
  const double sent_s = field.unit_s / *summary.time_rate;
  for (const Unit& unit : units) {
    if (unit.unit_s != field.unit_s && sent_s > 0.2 * unit.unit_s && sent_s < 5 * unit.unit_s) {
      return Finding{"stamps_unit", fmt::format("Stamps of poses look like {}. Send {} in {}.", unit.name,
                                                field.name, field.unit)};
    }
  }
  return std::nullopt;
}

/// Finds stamps that run backwards, or that advance too little for times.
std::optional<Finding> look_at_advance(const PoseStatistics::Summary& summary, const StampField& field) {
  const double time_rate = summary.time_rate.value_or(0.0);
  if (!shows_rate(summary) || time_rate == 0.0) {
    return std::nullopt;
  }
  if (time_rate < 0.0) {
    return Finding{"stamps_backwards",
                   fmt::format("Stamps run backwards by {:.2g} s per second, but sonard orders poses by "
                               "their stamps. {}",
                               -time_rate, advice(field))};
  }
  const double run_s = time_rate * static_cast<double>(summary.poses) / summary.rate_hz;
  if (run_s < shortest_run_s) {
    return Finding{"stamps_count",
                   fmt::format("Stamps advanced by only {:.2g} s over {} poses: do they count poses? {}",
                               run_s, summary.poses, advice(field))};
  }
  return std::nullopt;
}

/// Finds stamps that do not advance with the poses.
std::optional<Finding> look_at_standstill(const StampWatch& stamps, const StampField& field,
                                          PingClock clock) {
  const bool stops = clock != PingClock::wall;
  const char* const consequence = stops ? ", so the heads do not ping (poses.clock)" : "";
  switch (stamps.looks()) {
    case StampWatch::Looks::good:
      break;
    case StampWatch::Looks::stand_still:
      return Finding{"stamps_stand_still",
                     fmt::format("The stamps do not change while the vehicle moves{}: is {} missing? {}",
                                 consequence, field.name, advice(field)),
                     stops};
    case StampWatch::Looks::in_steps: {
      const double step_s = 1e-9 * static_cast<double>(stamps.last_step().count());
      return Finding{
          "stamps_in_steps",
          fmt::format("The stamps change only every {:.2g} s while the vehicle moves: is {} {}? {}", step_s,
                      field.name, step_s > 0.5 ? "in whole seconds" : "rounded", advice(field))};
    }
    case StampWatch::Looks::never_moved:
      return Finding{
          stops ? "stamps_never_moved" : "stamps_stand_still",
          fmt::format("The stamps have not changed since the first pose{}: is {}{} missing? {}", consequence,
                      stops ? "the simulation paused, or is " : "", field.name, advice(field)),
          stops};
  }
  return std::nullopt;
}

std::optional<Finding> look_at_restarts(const PoseStatistics::Summary& summary, const StampField& field) {
  if (!summary.since_restart || *summary.since_restart >= worth_saying) {
    return std::nullopt;
  }
  return Finding{"clock_backwards",
                 fmt::format("The publisher's clock went back {}: a simulation was restarted, or the "
                             "stamps ({}) come from several clocks.",
                             counted(summary.clock_restarts, "time"), field.name)};
}

}  // namespace

// The order matters: stamps in seconds also stand still for a second at a time.
std::optional<Finding> look_at_stamps(const PoseStatistics& statistics, const StampField& field,
                                      PingClock clock, TimePoint now) {
  const PoseStatistics::Summary summary = statistics.in_all(now);
  const bool too_slow = clock != PingClock::wall && summary.time_rate.value_or(1.0) < least_time_rate;
  if (auto found = look_at_unit(summary, field)) {
    found->stops_pings = too_slow;
    return found;
  }
  if (auto found = look_at_standstill(statistics.stamps(), field, clock)) {
    return found;
  }
  if (auto found = look_at_advance(summary, field)) {
    found->stops_pings = too_slow;
    return found;
  }
  return look_at_restarts(summary, field);
}

std::optional<Finding> look_at_rate(const PoseStatistics& statistics, PingClock clock, TimePoint now) {
  const bool by_stamps = clock != PingClock::wall;
  const std::optional<double> rate_hz = statistics.slow_rate_hz(by_stamps, now);
  if (!rate_hz) {
    return std::nullopt;
  }
  return Finding{
      "poses_rare",
      fmt::format("Poses arrive at only {:.2g} Hz{}. Publish at 10 Hz or more, as is usual.", *rate_hz,
                  by_stamps ? " by their stamps, and sonard makes no ping in gaps beyond "
                              "poses.extrapolation_limit_ms"
                            : ", so the vehicle moves in jumps")};
}

std::vector<Finding> look_at_stream(const PoseInputs& inputs, std::size_t index, TimePoint now) {
  std::vector<Finding> findings;
  const std::vector<PublisherId> publishers = inputs.publishers(index, now);
  if (publishers.size() > 1) {
    std::vector<std::string> names;
    std::ranges::transform(publishers, std::back_inserter(names),
                           [](const PublisherId& id) { return to_string(id); });
    findings.push_back(
        {"several_publishers", fmt::format("{} publishers send poses at the same time: {}. Stop all but one.",
                                           publishers.size(), fmt::join(names, ", "))});
  }
  // Stamps of publishers with different clocks show nothing.
  const PoseStatistics& statistics = inputs.statistics(index);
  if (publishers.size() <= 1 || statistics.in_all(now).clock_restarts == 0) {
    if (auto found =
            look_at_stamps(statistics, inputs.source(index).stamp_field(), inputs.ping_clock(), now)) {
      findings.push_back(std::move(*found));
    } else if (auto rare = look_at_rate(statistics, inputs.ping_clock(), now)) {
      findings.push_back(std::move(*rare));
    }
  }
  if (std::string unreadable = inputs.source(index).unreadable(now); !unreadable.empty()) {
    findings.push_back({unreadable_code, std::move(unreadable)});
  }
  if (std::string remark = inputs.source(index).remark(); !remark.empty()) {
    findings.push_back({"depth_alone", std::move(remark)});
  }
  return findings;
}

}  // namespace sonard::server
