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

/// Of a run.
inline constexpr int most_pings = 10'000'000;

/// More than can be numbered. what() is one line.
struct TooManyPings : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Pings at even times of a trajectory, from its first stamp on, or at given stamps.
struct PingTimes {
  std::int64_t start_ns = 0;
  double period_ns = 1e9;                 ///< > 0
  std::vector<std::int64_t> stamps_ns{};  ///< of each ping; empty: they are even

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
  const std::vector<pose::TrajectoryPoint>& points() const { return trajectory_.points(); }
  /// At rest before the first and after the last point.
  render::Pose T_world_vehicle(std::int64_t time_ns) const;

  /// From here on the vehicle is taken to be at rest during every ping.
  void rest_in_all_pings() { always_rests_ = true; }
  /// The same of pings that fall into one of these steps, from point k to point k + 1; one for each step.
  void rest_in(std::vector<bool> steps) { rest_steps_ = std::move(steps); }
  /// Where the vehicle is when the last echo is back of a ping that was sent at `sent_ns`; where it was sent
  /// if it is at rest then.
  render::Pose T_world_vehicle_at_end(std::int64_t sent_ns, std::int64_t end_ns) const;

  /// A stamp as Unix time. A file whose first stamp is in 1980 or later as Unix time is taken to hold Unix
  /// times; the stamps of any other count from 1980-01-01 00:00:00 UTC, where the clock of .glf logs begins.
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
