// SPDX-License-Identifier: Apache-2.0
#include "server/diagnosis/pose_stream.hpp"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace sonard::server {
namespace {

constexpr std::uint64_t enough_poses = 20;       // enough to measure a clock's rate
constexpr std::chrono::minutes worth_saying{1};  // a clock that went back once is reported for so long

constexpr const char* wrong_unit = "stamps_unit";

struct Unit {
  std::string_view name;
  double time_rate;  ///< measured rate of stamps in this unit, read as nanoseconds
};
constexpr double shortest_run_s = 1e-3;  ///< stamps of all poses that span less are not times
constexpr std::array units{Unit{"microseconds", 1e-3}, Unit{"milliseconds", 1e-6}, Unit{"seconds", 1e-9}};

/// Compares the rate of the stamps with the clock.
std::optional<Finding> look_at_rate(const PoseStatistics::Summary& summary) {
  if (summary.poses < enough_poses || !summary.time_rate) {
    return std::nullopt;
  }
  const double time_rate = *summary.time_rate;
  if (time_rate < 0.0) {
    return Finding{"stamps_backwards",
                   fmt::format("Stamps run backwards by {:.2g} s per second, but sonard orders poses by "
                               "their stamps. Send the time of each pose.",
                               -time_rate)};
  }
  for (const Unit& unit : units) {
    if (time_rate > 0.2 * unit.time_rate && time_rate < 5 * unit.time_rate) {
      return Finding{wrong_unit,
                     fmt::format("Stamps of poses look like {}. Send them in nanoseconds.", unit.name)};
    }
  }
  const double run_s = time_rate * static_cast<double>(summary.poses) / summary.rate_hz;
  if (run_s < shortest_run_s) {
    return Finding{"stamps_count", fmt::format("Stamps advanced by only {:.2g} s over {} poses: do they "
                                               "count poses? Send the time of each pose, in nanoseconds.",
                                               run_s, summary.poses)};
  }
  return std::nullopt;
}

/// Finds stamps that do not advance with the poses.
std::optional<Finding> look_at_stamps(const StampWatch& stamps, const std::string& name, PingClock clock) {
  switch (stamps.looks()) {
    case StampWatch::Looks::good:
      break;
    case StampWatch::Looks::stand_still:
      return Finding{"stamps_stand_still", fmt::format("The stamps do not change while the vehicle moves: is "
                                                       "{0} missing? Send the time of each pose as {0}.",
                                                       name)};
    case StampWatch::Looks::in_steps: {
      const double step_s = 1e-9 * static_cast<double>(stamps.last_step().count());
      return Finding{"stamps_in_steps",
                     fmt::format("The stamps change only every {:.2g} s while the vehicle moves: is {} {}? "
                                 "Send the time of each pose, with its fraction.",
                                 step_s, name, step_s > 0.5 ? "in whole seconds" : "rounded")};
    }
    case StampWatch::Looks::never_moved:
      if (clock == PingClock::wall) {
        return Finding{"stamps_stand_still", fmt::format("The stamps have not changed since the first pose: "
                                                         "is {0} missing? Send the time of each pose as {0}.",
                                                         name)};
      }
      return Finding{no_ping_by_stamps,
                     fmt::format("The stamps have not changed since the first pose, so the heads do not ping "
                                 "(poses.clock): is the simulation paused, or is {} missing?",
                                 name)};
  }
  return std::nullopt;
}

}  // namespace

std::vector<Finding> look_at_stream(const PoseInputs& inputs, std::size_t index, TimePoint now) {
  std::vector<Finding> findings;
  const PoseStatistics::Summary summary = inputs.statistics(index).in_all(now);
  const std::vector<std::string> publishers = inputs.publishers(index, now);
  if (publishers.size() > 1) {
    findings.push_back(
        {"several_publishers", fmt::format("{} publishers send poses at the same time: {}. Stop all but one.",
                                           publishers.size(), fmt::join(publishers, ", "))});
  } else if (summary.since_restart && *summary.since_restart < worth_saying) {
    findings.push_back(
        {"clock_backwards", fmt::format("The publisher's clock went back {} time{}: a simulation was "
                                        "restarted, or the stamps come from several clocks.",
                                        summary.clock_restarts, summary.clock_restarts == 1 ? "" : "s")});
  }
  auto of_rate = look_at_rate(summary);
  // Stamps in seconds also stand still for a second at a time.
  if (!of_rate || of_rate->code != wrong_unit) {
    if (auto found = look_at_stamps(inputs.statistics(index).stamps(), inputs.source(index).stamp_name(),
                                    inputs.ping_clock())) {
      findings.push_back(std::move(*found));
    }
  }
  if (std::string remark = inputs.source(index).remark(); !remark.empty()) {
    findings.push_back({"depth_alone", std::move(remark)});
  }
  if (of_rate) {
    findings.push_back(std::move(*of_rate));
  }
  return findings;
}

}  // namespace sonard::server
