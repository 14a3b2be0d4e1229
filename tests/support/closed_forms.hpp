// SPDX-License-Identifier: Apache-2.0
// Echoes in closed form: the truth for tests of the renderer. Double precision, and no code shared with
// renderer/. Formulas: docs/physics.md 3.2.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace sonard::test {

/// Integral of cos^4 from 0 to u.
inline double cos4_integral(double u) {
  return 3 * u / 8 + std::sin(2 * u) / 4 + std::sin(4 * u) / 32;
}

/// Integral of `density` over azimuth, by the midpoint rule with many nodes, because range lines make kinks.
template <class Density>
double azimuth_integral(Density density, double psi_from, double psi_to, int nodes) {
  const double step = (psi_to - psi_from) / nodes;
  double sum = 0;
  for (int i = 0; i < nodes; ++i) {
    sum += density(psi_from + (i + 0.5) * step) * step;
  }
  return sum;
}

/// A plane at perpendicular distance `distance_m`, mu = 1, alpha = 0 (T1; T2 and T3 are its special cases).
/// The unit normal (nx, ny, nz) points from the sonar to the plane.
struct PlaneTruth {
  double distance_m, nx, ny, nz;
  double elevation_limit_rad;

  /// Echo per unit azimuth from ranges [r1, r2).
  double density(double psi, double r1, double r2) const {
    return density(psi, r1, r2, -elevation_limit_rad, elevation_limit_rad);
  }

  /// Echo per unit azimuth of the elevations [theta_low, theta_high) only, for planes that are partly hidden.
  double density(double psi, double r1, double r2, double theta_low, double theta_high) const {
    const double horizontal = nx * std::cos(psi) + ny * std::sin(psi);
    const double amplitude = std::hypot(horizontal, nz);
    const double centre = std::atan2(nz, horizontal);
    // r = D / (A cos u), u = theta - centre: each range has two elevations, one on each side of the foot
    // point.
    const double inner = u_of_range(amplitude, r1);
    const double outer = u_of_range(amplitude, r2);
    double sum = 0;
    sum += piece(centre, inner, outer, theta_low, theta_high);
    sum += piece(centre, -outer, -inner, theta_low, theta_high);
    return amplitude * amplitude * amplitude / (distance_m * distance_m) * sum;
  }

  /// Echo of a beam between two azimuths.
  double beam(double psi_from, double psi_to, double r1, double r2, int nodes = 400) const {
    return azimuth_integral([&](double psi) { return density(psi, r1, r2); }, psi_from, psi_to, nodes);
  }

 private:
  double u_of_range(double amplitude, double range_m) const {
    const double cosine = distance_m / (amplitude * range_m);
    return cosine >= 1 ? 0.0 : std::acos(cosine);
  }
  double primitive(double centre, double u) const {
    return std::cos(centre) * cos4_integral(u) + std::sin(centre) * std::pow(std::cos(u), 4) / 4;
  }
  double piece(double centre, double u1, double u2, double theta_low, double theta_high) const {
    const double low = std::max(u1, theta_low - centre);
    const double high = std::min(u2, theta_high - centre);
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

/// T5: an upright cylinder of radius a that fills the height of the fan, with its axis straight ahead at
/// horizontal distance R0. Echo per unit azimuth from ranges [r1, r2).
inline double cylinder_density(double radius_m, double axis_m, double elevation_limit_rad, double psi,
                               double r1, double r2) {
  const double across = axis_m * std::sin(psi) / radius_m;
  if (std::abs(across) >= 1) {
    return 0;
  }
  const double facing = std::sqrt(1 - across * across);
  const double near = axis_m * std::cos(psi) - radius_m * facing;
  const auto elevation = [&](double r) { return r > near ? std::acos(near / r) : 0.0; };
  const double low = std::min(elevation(r1), elevation_limit_rad);
  const double high = std::min(elevation(r2), elevation_limit_rad);
  return 2 * facing / (near * near) * (cos4_integral(high) - cos4_integral(low));
}

/// T7: a wide thin wall of height H across the axis at horizontal distance x, on a flat bed at depth h > H
/// below a level sonar. The wall's echo overlaps the bed in front of it; the wall hides the bed behind it.
struct ShadowTruth {
  double altitude_m, wall_height_m, wall_m, elevation_limit_rad;

  double density(double psi, double r1, double r2) const {
    const PlaneTruth bed{altitude_m, 0, 0, -1, elevation_limit_rad};
    const PlaneTruth wall{wall_m, 1, 0, 0, elevation_limit_rad};
    const double base = std::atan2(-altitude_m * std::cos(psi), wall_m);
    const double top = std::atan2((wall_height_m - altitude_m) * std::cos(psi), wall_m);
    const double limit = elevation_limit_rad;
    const auto inside = [&](double theta) { return std::clamp(theta, -limit, limit); };
    return bed.density(psi, r1, r2, -limit, inside(base)) +
           wall.density(psi, r1, r2, inside(base), inside(top)) +
           bed.density(psi, r1, r2, inside(top), limit);
  }
};

/// Lambert's law plus facets (docs/physics.md 2.4).
struct FacetLaw {
  double reflection;  ///< R
  double slope;       ///< m
  double lambert_mu;

  /// Backscatter strength per area, s_b.
  double strength(double cos_incidence) const {
    const double c2 = cos_incidence * cos_incidence;
    const double tan2 = 1 / c2 - 1;
    const double m2 = slope * slope;
    return lambert_mu * c2 +
           reflection * reflection / (8 * std::acos(-1.0) * m2 * c2 * c2) * std::exp(-tan2 / (2 * m2));
  }
  /// Echo of a surface, relative to a surface with mu = 1.
  double relative(double cos_incidence) const {
    const double cosine = std::min(cos_incidence, 1.0);
    return cosine > 0 ? strength(cosine) / (cosine * cosine) : 0.0;
  }
};

/// Echo of ranges [r1, r2), weighted with a share that depends on range only, because all sound of one range
/// has the same incidence.
/// @param echo echo of ranges [from, to) without the share
/// @param share share at a range
/// @param nearest_m the first range; shares are smooth in sqrt(range - nearest_m)
template <class Echo, class Share>
double weighted_echo(const Echo& echo, const Share& share, double nearest_m, double r1, double r2,
                     int steps) {
  if (r2 <= nearest_m) {
    return 0.0;
  }
  const double first = std::sqrt(std::max(0.0, r1 - nearest_m));
  const double step = (std::sqrt(r2 - nearest_m) - first) / steps;
  const auto range = [&](double i) { return nearest_m + std::pow(first + i * step, 2); };
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double heard = echo(range(i), range(i + 1));
    sum += heard > 0 ? heard * share(range(i + 0.5)) : 0.0;
  }
  return sum;
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
