// SPDX-License-Identifier: Apache-2.0
// A vehicle's trajectory, with the times of pings and logs.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "protocol/pose/trajectory.hpp"
#include "renderer/pose.hpp"

namespace sonard::server {

/// in a run
inline constexpr int most_pings = 10'000'000;

/// Pings at regular times of a trajectory, from its first stamp on, or at given stamps.
struct PingTimes {
  std::int64_t start_ns = 0;
  double period_ns = 1e9;                 ///< > 0
  std::vector<std::int64_t> stamps_ns{};  ///< of each ping; empty: regular times

  std::int64_t at(std::int64_t ping) const;
  /// Number of pings up to and including `end_ns`; at least one.
  /// @throws Error if there are more pings than can be numbered
  int count_until(std::int64_t end_ns) const;
};

/// Times are stamps of the trajectory file, in nanoseconds.
class VehicleTrajectory {
 public:
  /// @param vehicle_model the body of the world that moves along; empty: no body does
  explicit VehicleTrajectory(pose::Trajectory trajectory, std::string vehicle_model = {})
      : trajectory_(std::move(trajectory)), vehicle_model_(std::move(vehicle_model)) {}

  const std::string& vehicle_model() const { return vehicle_model_; }

  /// Trajectory of a body of the world, on the same clock; at rest before the first and after the last point.
  struct BodyWay {
    std::string body;
    pose::Trajectory trajectory;
    render::Pose T_world_body(std::int64_t time_ns) const;
  };
  const std::vector<BodyWay>& bodies() const { return bodies_; }
  void add(BodyWay way) { bodies_.push_back(std::move(way)); }

  std::int64_t start_ns() const { return trajectory_.start_ns(); }
  std::int64_t end_ns() const { return trajectory_.end_ns(); }
  const std::vector<pose::TrajectoryPoint>& points() const { return trajectory_.points(); }
  /// Pose at a time; at rest before the first and after the last point.
  render::Pose T_world_vehicle(std::int64_t time_ns) const;

  /// From now on the vehicle counts as at rest during every ping.
  void rest_in_all_pings() { always_rests_ = true; }
  /// The same, for pings within marked steps, from point k to point k + 1. @param steps one for each step
  void rest_in(std::vector<bool> steps) { rest_steps_ = std::move(steps); }
  /// Pose of the vehicle when the last echo returns of a ping that was sent at `sent_ns`; if the vehicle is
  /// at rest, its pose at `sent_ns`.
  render::Pose T_world_vehicle_at_end(std::int64_t sent_ns, std::int64_t end_ns) const;

  /// A stamp as Unix time. If the first stamp of the file, as Unix time, is in 1980 or later, stamps are Unix
  /// times. Otherwise they count from 1980-01-01 00:00:00 UTC, where the clock of .glf logs begins.
  std::int64_t unix_ns(std::int64_t time_ns) const;

 private:
  bool rests(std::int64_t sent_ns, std::int64_t end_ns) const;

  pose::Trajectory trajectory_;
  bool always_rests_ = false;
  std::vector<bool> rest_steps_;
  std::string vehicle_model_;
  std::vector<BodyWay> bodies_;
};

}  // namespace sonard::server
