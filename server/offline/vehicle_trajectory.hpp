// SPDX-License-Identifier: Apache-2.0
// A trajectory as the way of a vehicle, on the clocks of what is made of it.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "protocol/pose/trajectory.hpp"
#include "renderer/pose.hpp"

namespace sonard::server {

/// More than can be numbered. what() is one line.
struct TooManyPings : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Pings at even times of a trajectory, from its first stamp on.
struct PingTimes {
  std::int64_t start_ns = 0;
  double period_ns = 1e9;  ///< > 0

  std::int64_t at(std::int64_t ping) const;
  /// How many there are until `end_ns`, which is included; at least one.
  /// @throws TooManyPings
  int count_until(std::int64_t end_ns) const;
};

/// Stamps are those of the trajectory file, in nanoseconds.
class VehicleTrajectory {
 public:
  /// @param vehicle_model the body of the world that moves along; empty: none does
  explicit VehicleTrajectory(pose::Trajectory trajectory, std::string vehicle_model = {})
      : trajectory_(std::move(trajectory)), vehicle_model_(std::move(vehicle_model)) {}

  const std::string& vehicle_model() const { return vehicle_model_; }

  /// Where a body of the world is, on the same clock; at rest before the first and after the last point.
  struct BodyWay {
    std::string body;
    pose::Trajectory trajectory;
    render::Pose T_world_body(std::int64_t time_ns) const;
  };
  const std::vector<BodyWay>& bodies() const { return bodies_; }
  void add(BodyWay way) { bodies_.push_back(std::move(way)); }

  std::int64_t start_ns() const { return trajectory_.start_ns(); }
  std::int64_t end_ns() const { return trajectory_.end_ns(); }
  /// At rest before the first and after the last point.
  render::Pose T_world_vehicle(std::int64_t time_ns) const;

  /// A stamp as Unix time. A file whose first stamp is in 1980 or later as Unix time is taken to hold Unix
  /// times; the stamps of any other count from 1980-01-01 00:00:00 UTC, where the clock of .glf logs begins.
  std::int64_t unix_ns(std::int64_t time_ns) const;

 private:
  pose::Trajectory trajectory_;
  std::string vehicle_model_;
  std::vector<BodyWay> bodies_;
};

}  // namespace sonard::server
