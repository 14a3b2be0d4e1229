// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/beams.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sonard::dvl_a50 {
namespace {

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double determinant(const Matrix& m) {
  return dot(m[0], cross(m[1], m[2]));
}

/// Of a symmetric matrix with a determinant above 0.
Matrix inverse(const Matrix& m) {
  Matrix result{cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])};
  for (Vector& row : result) {
    for (double& element : row) {
      element /= determinant(m);
    }
  }
  return result;
}

Matrix turn_matrix(double rad) {
  return {{{std::cos(rad), -std::sin(rad), 0.0}, {std::sin(rad), std::cos(rad), 0.0}, {0.0, 0.0, 1.0}}};
}

}  // namespace

double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

std::optional<Solution> solve(const std::array<Beam, 4>& beams, double noise_mps) {
  Matrix squares{};  // U^T U
  Vector sums{};     // U^T b
  for (std::size_t beam = 0; beam < beams.size(); ++beam) {
    const Vector& u = beam_directions[beam];
    for (std::size_t i = 0; beams[beam].valid && i < 3; ++i) {
      sums[i] += u[i] * beams[beam].velocity_mps;
      for (std::size_t k = 0; k < 3; ++k) {
        squares[i][k] += u[i] * u[k];
      }
    }
  }
  if (std::ranges::count(beams, true, &Beam::valid) < 3) {
    return std::nullopt;
  }
  Solution solution{{}, inverse(squares)};
  for (std::size_t i = 0; i < 3; ++i) {
    solution.velocity_mps[i] = dot(solution.covariance[i], sums);
    for (double& element : solution.covariance[i]) {
      element *= noise_mps * noise_mps;
    }
  }
  return solution;
}

/// The closed form of a symmetric matrix: with C = q 1 + p B, the eigenvalues of B are 2 cos of three angles.
double figure_of_merit(const Matrix& c) {
  const double q = (c[0][0] + c[1][1] + c[2][2]) / 3.0;
  Matrix rest = c;
  double squares = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    rest[i][i] -= q;
    squares += dot(rest[i], rest[i]);
  }
  const double p = std::sqrt(squares / 6.0);
  if (!(p > 0.0)) {
    return std::sqrt(std::max(0.0, q));
  }
  for (Vector& row : rest) {
    for (double& element : row) {
      element /= p;
    }
  }
  const double angle_rad = std::acos(std::clamp(determinant(rest) / 2.0, -1.0, 1.0)) / 3.0;
  return std::sqrt(std::max(0.0, q + 2.0 * p * std::cos(angle_rad)));
}

std::optional<double> altitude_m(const std::array<Beam, 4>& beams, double offset_m) {
  double sum_m = 0.0;
  int count = 0;
  for (const Beam& beam : beams) {
    if (beam.distance_m >= 0.0) {
      sum_m += beam.distance_m;
      ++count;
    }
  }
  return count > 0 ? std::optional(sum_m / count * beam_cosine + offset_m) : std::nullopt;
}

Vector to_vehicle(const Vector& of_device, double rad) {
  const Matrix turn = turn_matrix(rad);
  return {dot(turn[0], of_device), dot(turn[1], of_device), of_device[2]};
}

Matrix to_vehicle(const Matrix& of_device, double rad) {
  const Matrix turn = turn_matrix(rad);
  Matrix result{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t j = 0; j < 3; ++j) {
        result[i][k] += turn[i][j] * dot(of_device[j], turn[k]);
      }
    }
  }
  return result;
}

}  // namespace sonard::dvl_a50
