// Echoes that can be written down: the truth for tests of the renderer. Independent of renderer/: double
// precision, no code shared. Formulas: docs/physics.md 3.2.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace sonard::test {

/// Integral of cos^4 from 0 to u.
inline double cos4_integral(double u) {
  return 3 * u / 8 + std::sin(2 * u) / 4 + std::sin(4 * u) / 32;
}

/// A plane at perpendicular distance `distance_m`, unit normal (nx, ny, nz) pointing from the sonar to it, mu
/// = 1, alpha = 0 (T1; T2 and T3 are its special cases).
struct PlaneTruth {
  double distance_m, nx, ny, nz;
  double elevation_limit_rad;

  /// Echo per unit azimuth from ranges [r1, r2).
  double density(double psi, double r1, double r2) const {
    const double horizontal = nx * std::cos(psi) + ny * std::sin(psi);
    const double amplitude = std::hypot(horizontal, nz);
    const double centre = std::atan2(nz, horizontal);
    // r = D / (A cos u), u = theta - centre: each range is at two elevations, one on either side of the foot
    // point.
    const double inner = u_of_range(amplitude, r1);
    const double outer = u_of_range(amplitude, r2);
    double sum = 0;
    sum += piece(centre, inner, outer);
    sum += piece(centre, -outer, -inner);
    return amplitude * amplitude * amplitude / (distance_m * distance_m) * sum;
  }

  /// Echo of a beam between two azimuths, by Gauss-Legendre-free brute force: midpoint rule with many nodes,
  /// since range lines make kinks.
  double beam(double psi_from, double psi_to, double r1, double r2, int nodes = 400) const {
    const double step = (psi_to - psi_from) / nodes;
    double sum = 0;
    for (int i = 0; i < nodes; ++i) {
      sum += density(psi_from + (i + 0.5) * step, r1, r2) * step;
    }
    return sum;
  }

 private:
  double u_of_range(double amplitude, double range_m) const {
    const double cosine = distance_m / (amplitude * range_m);
    return cosine >= 1 ? 0.0 : std::acos(cosine);
  }
  double primitive(double centre, double u) const {
    return std::cos(centre) * cos4_integral(u) + std::sin(centre) * std::pow(std::cos(u), 4) / 4;
  }
  double piece(double centre, double u1, double u2) const {
    const double low = std::max(u1, -elevation_limit_rad - centre);
    const double high = std::min(u2, elevation_limit_rad - centre);
    return high > low ? primitive(centre, high) - primitive(centre, low) : 0.0;
  }
};

/// T4: sphere of radius a, centre at distance R0, wholly inside the fan; summed over beams, ranges [r1, r2).
inline double sphere_echo(double radius_m, double centre_m, double r1, double r2) {
  const double l2 = centre_m * centre_m - radius_m * radius_m;
  const auto primitive = [&](double r) {
    return -l2 * l2 / (4 * std::pow(r, 4)) + l2 / (r * r) + std::log(r);
  };
  const double low = std::clamp(r1, centre_m - radius_m, std::sqrt(l2));
  const double high = std::clamp(r2, centre_m - radius_m, std::sqrt(l2));
  return std::acos(-1.0) / (2 * radius_m * centre_m) * (primitive(high) - primitive(low));
}

/// RMS relative error over all values above `threshold` times the largest truth (docs/physics.md 3.3).
inline double rms_error(const std::vector<double>& truth, const std::vector<double>& measured,
                        double threshold) {
  const double strongest = *std::max_element(truth.begin(), truth.end());
  double squared = 0;
  int count = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth[i] > threshold * strongest) {
      const double error = measured[i] / truth[i] - 1;
      squared += error * error;
      ++count;
    }
  }
  return std::sqrt(squared / count);
}

}  // namespace sonard::test
