// SPDX-License-Identifier: Apache-2.0
// The four beams, and what follows from their velocities and distances (3, 4).
#pragma once

#include <array>
#include <optional>

#include "protocol/dvl_a50/messages.hpp"

namespace sonard::dvl_a50 {

inline constexpr double beam_cosine = 0.9238795325112867;    ///< of 22.5 degrees, to the z axis
inline constexpr double beam_lateral = 0.27059805007309849;  ///< sin 22.5 degrees / sqrt 2

/// Unit vectors out of the transducers, by the id of the beam.
inline constexpr std::array<Vector, 4> beam_directions{{{-beam_lateral, beam_lateral, beam_cosine},
                                                        {-beam_lateral, -beam_lateral, beam_cosine},
                                                        {beam_lateral, -beam_lateral, beam_cosine},
                                                        {beam_lateral, beam_lateral, beam_cosine}}};

double dot(const Vector& a, const Vector& b);

/// What the beams tell of the motion, in the frame of the device.
struct Solution {
  Vector velocity_mps{};
  Matrix covariance{};
};
/// Least squares over the valid beams, whose velocities have `noise_mps` as their standard deviation.
/// @return nullopt if fewer than three beams are valid
std::optional<Solution> solve(const std::array<Beam, 4>& beams, double noise_mps);

/// The square root of the largest eigenvalue of a covariance.
double figure_of_merit(const Matrix& covariance);

/// Along z, from the mean of the distances that are there; nullopt: there are none. `offset_m` is added.
std::optional<double> altitude_m(const std::array<Beam, 4>& beams, double offset_m);

/// The vector, or both sides of the matrix, rotated about z from the axes of the device to those of the
/// vehicle, from whose forward axis the device is turned clockwise by `rad`.
Vector to_vehicle(const Vector& of_device, double rad);
Matrix to_vehicle(const Matrix& of_device, double rad);

}  // namespace sonard::dvl_a50
