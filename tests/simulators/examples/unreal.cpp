// SPDX-License-Identifier: Apache-2.0
// Stands in for Unreal: centimetres, x forward, y right, z up; angles pitch (up), yaw (clockwise), roll
// (clockwise as seen from behind), applied to the vehicle in the order roll, pitch, yaw. Velocities are in
// the world's axes, as in the engine. Turn rates have the sign of its quaternions (left-handed, see the
// documentation of TRotator).
#include "clients/examples/unreal/SonardPose.h"
#include "tests/simulators/examples/simulator.hpp"

namespace {

struct FVector {
  double X, Y, Z;
};

struct FQuat {
  double X, Y, Z, W;

  FQuat operator*(const FQuat& b) const {
    return {W * b.X + X * b.W + Y * b.Z - Z * b.Y, W * b.Y - X * b.Z + Y * b.W + Z * b.X,
            W * b.Z + X * b.Y - Y * b.X + Z * b.W, W * b.W - X * b.X - Y * b.Y - Z * b.Z};
  }
  FVector UnrotateVector(const FVector& v) const {
    const FQuat turned = FQuat{-X, -Y, -Z, W} * FQuat{v.X, v.Y, v.Z, 0} * *this;
    return {turned.X, turned.Y, turned.Z};
  }
};

/// A positive angle rotates x to y, y to z, z to x, whatever the handedness of the axes.
FQuat about(double x, double y, double z, double angle_rad) {
  const double s = std::sin(angle_rad / 2);
  return {s * x, s * y, s * z, std::cos(angle_rad / 2)};
}

/// Yaw rotates forward (x) to the right (y); pitch rotates forward to up (z to x backwards); roll rotates up
/// to the right (y to z backwards).
FQuat rotator(double pitch, double yaw, double roll) {
  return about(0, 0, 1, yaw) * about(0, 1, 0, -pitch) * about(1, 0, 0, -roll);
}

FVector vector(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

}  // namespace

int main(int argc, char** argv) {
  const int udp = socket(AF_INET, SOCK_DGRAM, 0);
  return sonard::test::simulate(
      argc, argv, [udp](const sonard::test::SimulatedState& state, std::uint16_t port) {
        const FQuat rotation = rotator(state.angles_rad[0], state.angles_rad[1], state.angles_rad[2]);
        std::string message = sonard_unreal::EncodeUpdate(
            state.seconds, sonard_unreal::Position(vector(state.position)),
            sonard_unreal::Orientation(rotation),
            sonard_unreal::Velocity(rotation.UnrotateVector(vector(state.velocity))),
            sonard_unreal::TurnRate(rotation.UnrotateVector(vector(state.turn_rate))));
        if (state.with_body) {
          const auto& angles = state.body_angles_rad;
          const FQuat turned = rotator(angles[0], angles[1], angles[2]);
          message += sonard_unreal::EncodeBody(
              "walls", sonard_unreal::Position(vector(state.body_position)),
              sonard_unreal::Orientation(turned),
              sonard_unreal::Velocity(turned.UnrotateVector(vector(state.body_velocity))),
              sonard_unreal::TurnRate(FVector{}));
        }
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_port = htons(port);
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        sendto(udp, message.data(), message.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
      });
}
