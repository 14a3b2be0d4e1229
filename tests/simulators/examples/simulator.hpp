// SPDX-License-Identifier: Apache-2.0
// Shared code of the stand-ins for simulators: sends the vehicle's state 50 times a second, COUNT times.
//   PROGRAM PORT COUNT X Y Z A B C VX VY VZ WX WY WZ [X Y Z A B C [VX VY VZ]]
// COUNT 0: until it is ended. Position, three angles in degrees, velocity and turn rate, all in the
// simulator's own axes, units and order; then position, angles and velocity of the body "walls".
#pragma once

#include <arpa/inet.h>
#include <sys/socket.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <string>
#include <thread>

namespace sonard::test {

struct SimulatedState {
  double seconds = 0.0;
  std::array<double, 3> position;
  std::array<double, 3> angles_rad;
  std::array<double, 3> velocity;
  std::array<double, 3> turn_rate;
  bool with_body = false;
  std::array<double, 3> body_position{};
  std::array<double, 3> body_angles_rad{};
  std::array<double, 3> body_velocity{};
};

/// Calls `step` every 20 ms with the state of the command line. @return the exit status.
inline int simulate(int argc, char** argv,
                    const std::function<void(const SimulatedState&, std::uint16_t port)>& step) {
  if (argc != 15 && argc != 21 && argc != 24) {
    std::fprintf(stderr, "usage: %s PORT COUNT and 12, 18 or 21 numbers\n", argv[0]);
    return 2;
  }
  const auto numbers = [argv](int first, double scale) {
    return std::array<double, 3>{scale * std::atof(argv[first]), scale * std::atof(argv[first + 1]),
                                 scale * std::atof(argv[first + 2])};
  };
  constexpr double degree = std::numbers::pi / 180;
  SimulatedState state{0.0, numbers(3, 1.0), numbers(6, degree), numbers(9, 1.0), numbers(12, 1.0)};
  if (argc >= 21) {
    state.with_body = true;
    state.body_position = numbers(15, 1.0);
    state.body_angles_rad = numbers(18, degree);
  }
  if (argc == 24) {
    state.body_velocity = numbers(21, 1.0);
  }
  const int count = std::atoi(argv[2]);
  for (int i = 0; count == 0 || i < count; ++i) {
    state.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    step(state, static_cast<std::uint16_t>(std::atoi(argv[1])));
    std::this_thread::sleep_for(std::chrono::milliseconds{20});
  }
  return 0;
}

}  // namespace sonard::test
