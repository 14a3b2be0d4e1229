// SPDX-License-Identifier: Apache-2.0
// Stands in for Stonefish: metres, north, east, down; angles roll, pitch, yaw; velocities on board, as its
// odometry sensor measures them.
#include "clients/examples/stonefish/sonard_publisher.hpp"

#include <optional>

#include "tests/simulators/examples/simulator.hpp"

namespace {

/// The part of sf::Sample in use: 13 numbers and a time.
struct Sample {
  std::array<double, 13> values;
  double time_s;
  double getTimestamp() const { return time_s; }
  double getValue(std::size_t dimension) const { return values.at(dimension); }
};

/// Yaw, then pitch, then roll, each about the axes as rotated so far; x, y, z, w.
std::array<double, 4> quaternion(const std::array<double, 3>& rpy_rad) {
  const double cr = std::cos(rpy_rad[0] / 2), cp = std::cos(rpy_rad[1] / 2), cy = std::cos(rpy_rad[2] / 2);
  const double sr = std::sin(rpy_rad[0] / 2), sp = std::sin(rpy_rad[1] / 2), sy = std::sin(rpy_rad[2] / 2);
  return {sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy,
          cr * cp * cy + sr * sp * sy};
}

}  // namespace

int main(int argc, char** argv) {
  std::optional<SonardPublisher> publisher;
  return sonard::test::simulate(
      argc, argv, [&](const sonard::test::SimulatedState& state, std::uint16_t port) {
        if (!publisher) {
          publisher.emplace("127.0.0.1", port);
        }
        const auto& [p, v, w] = std::array{state.position, state.velocity, state.turn_rate};
        const std::array<double, 4> q = quaternion(state.angles_rad);
        publisher->send(Sample{{p[0], p[1], p[2], v[0], v[1], v[2], q[0], q[1], q[2], q[3], w[0], w[1], w[2]},
                               state.seconds});
      });
}
