// SPDX-License-Identifier: Apache-2.0
#include "server/offline/jumps.hpp"

#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "renderer/pose.hpp"
#include "server/pose/to_render.hpp"

namespace sonard::server {
namespace {

constexpr double independent_share = 0.25;

/// The uniform motion from one point to the next, in world axes.
struct Step {
  double seconds = 0.0;
  glm::dvec3 velocity_mps{0.0};
  glm::dvec3 turn_radps{0.0};

  bool jump() const {
    return glm::length(velocity_mps) > fastest_vehicle_mps || glm::length(turn_radps) > fastest_turn_radps;
  }
};

Step step_between(const pose::TrajectoryPoint& from, const pose::TrajectoryPoint& to) {
  const render::Pose a = to_render(from.T_world_vehicle);
  const render::Pose b = to_render(to.T_world_vehicle);
  const double seconds = 1e-9 * static_cast<double>(to.time_ns - from.time_ns);
  glm::dquat turn = b.orientation * glm::conjugate(a.orientation);
  if (turn.w < 0) {
    turn = -turn;  // the shorter way
  }
  const glm::dvec3 axis(turn.x, turn.y, turn.z);
  const double sine = glm::length(axis);
  const glm::dvec3 turned_rad = sine > 0 ? axis / sine * (2.0 * std::atan2(sine, turn.w)) : glm::dvec3(0.0);
  return {seconds, (b.position_m - a.position_m) / seconds, turned_rad / seconds};
}

/// True if a vehicle can make both steps, one after the other.
bool continues(const Step& before, const Step& step) {
  const double between_s = (before.seconds + step.seconds) / 2.0;
  return glm::length(step.velocity_mps - before.velocity_mps) <= most_acceleration_mps2 * between_s &&
         glm::length(step.turn_radps - before.turn_radps) <= most_turn_acceleration_radps2 * between_s;
}

constexpr double degrees = 57.29577951308232;

std::string times_text(const pose::TrajectoryPoint& from, const pose::TrajectoryPoint& to) {
  return fmt::format("from t={:g} to t={:g}: ", 1e-9 * static_cast<double>(from.time_ns),
                     1e-9 * static_cast<double>(to.time_ns));
}

std::string speeds_text(const Step& step) {
  return fmt::format("{:.3g} m/s, {:.3g} deg/s", glm::length(step.velocity_mps),
                     glm::length(step.turn_radps) * degrees);
}

/// The changes between two steps.
std::string change_text(const Step& before, const Step& step) {
  return fmt::format("velocity changes by {:.3g} m/s and turn rate by {:.3g} deg/s within {:.3g} s",
                     glm::length(step.velocity_mps - before.velocity_mps),
                     glm::length(step.turn_radps - before.turn_radps) * degrees,
                     (before.seconds + step.seconds) / 2.0);
}

bool are_many(std::size_t broken, std::size_t steps) {
  return broken > 0 && static_cast<double>(broken) >= independent_share * static_cast<double>(steps);
}

/// True if many steps, each of shortest_compared_step_s or more, are jumps or do not continue the step
/// before.
bool many_steps_break(const std::vector<pose::TrajectoryPoint>& points, Jumps& jumps) {
  std::size_t steps = 0;
  std::size_t broken = 0;
  std::optional<Step> before;
  std::size_t from = 0;
  for (std::size_t to = 1; to < points.size(); ++to) {
    const Step step = step_between(points[from], points[to]);
    if (step.seconds < shortest_compared_step_s) {
      continue;
    }
    ++steps;
    const bool breaks = before && !continues(*before, step);
    broken += step.jump() || breaks ? 1 : 0;
    if (jumps.first.empty() && (step.jump() || breaks)) {
      jumps.first = times_text(points[from], points[to]) +
                    (step.jump() ? speeds_text(step) : change_text(*before, step));
    }
    before = step;
    from = to;
  }
  return are_many(broken, steps);
}

}  // namespace

Jumps find_jumps(const std::vector<pose::TrajectoryPoint>& points) {
  Jumps jumps;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const Step step = step_between(points[k], points[k + 1]);
    jumps.steps.push_back(step.jump());
    if (step.jump()) {
      ++jumps.count;
      if (jumps.first.empty()) {
        jumps.first = times_text(points[k], points[k + 1]) + speeds_text(step);
      }
    }
  }
  const bool many_break = many_steps_break(points, jumps);  // may set jumps.first
  jumps.independent = many_break || are_many(jumps.count, jumps.steps.size());
  return jumps;
}

}  // namespace sonard::server
