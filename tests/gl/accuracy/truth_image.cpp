// SPDX-License-Identifier: Apache-2.0
#include "tests/gl/accuracy/truth_image.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/kink_quadrature.hpp"

namespace sonard::test {

namespace {

constexpr double right_angle = std::numbers::pi / 2;

/// Adds the two azimuths at which the cosine of the angle from `centre` is `cosine`; NaN if there is no such
/// azimuth.
void add_cosine(double cosine, double centre, std::vector<double>& kinks) {
  const double aside = std::acos(cosine);
  kinks.push_back(centre - aside);
  kinks.push_back(centre + aside);
}

}  // namespace

double SphereTruth::limb_squared() const {
  return horizontal_m * horizontal_m + height_m * height_m - radius_m * radius_m;
}

// The half-plane of one azimuth cuts a circle whose centre is at distance R. With u the angle from its
// centre, cos u = (r^2 + L^2) / (2 r R), L the tangent's length, and each range is at two elevations.
double SphereTruth::density(double psi, double r1, double r2) const {
  const double limb2 = limb_squared();
  const double across_m = horizontal_m * std::cos(psi - azimuth_rad);
  const double centre_m = std::hypot(across_m, height_m);
  if (across_m <= 0 || centre_m * centre_m <= limb2) {
    return 0;
  }
  const double nearest = centre_m - std::sqrt(centre_m * centre_m - limb2);
  const double from = std::max(r1, nearest), to = std::min(r2, std::sqrt(limb2));
  if (to <= from) {
    return 0;
  }
  // In s, r = nearest + s^2, sin u / s is smooth: 1 - cos u = s^2 (2 rho - s^2) / (2 r R), rho the circle's
  // radius.
  const auto per_root = [&](double s) {
    const double r = nearest + s * s;
    const double cos_u = (r * r + limb2) / (2 * r * centre_m);
    const double sin_u_by_s =
        std::sqrt((2 * (centre_m - nearest) - s * s) / (2 * r * centre_m) * (1 + cos_u));
    const double slope = (limb2 / (r * r) - 1) / (2 * centre_m);
    const double cos_incidence = (limb2 - r * r) / (2 * r * radius_m);
    return 4 * cos_incidence / (r * r) * (across_m / centre_m) * cos_u * slope / sin_u_by_s;
  };
  return smooth_integral(per_root, std::sqrt(from - nearest), std::sqrt(to - nearest));
}

double SphereTruth::beam(double psi_from, double psi_to, double r1, double r2) const {
  const double limb2 = limb_squared();
  if (r1 * r1 > limb2 || r2 < std::hypot(horizontal_m, height_m) - radius_m) {
    return 0;
  }
  std::vector<double> kinks;
  add_cosine(std::sqrt(limb2 - height_m * height_m) / horizontal_m, azimuth_rad, kinks);
  for (const double r : {r1, r2}) {
    const double centre_m = (r * r + limb2) / (2 * r);  // of the circle that begins at r
    add_cosine(std::sqrt(centre_m * centre_m - height_m * height_m) / horizontal_m, azimuth_rad, kinks);
  }
  return kinked_integral([&](double psi) { return density(psi, r1, r2); }, psi_from, psi_to, kinks);
}

double CylinderTruth::beam(double psi_from, double psi_to, double r1, double r2) const {
  std::vector<double> kinks;
  const double tangent2 = axis_m * axis_m - radius_m * radius_m;
  add_cosine(std::sqrt(tangent2) / axis_m, azimuth_rad, kinks);
  for (const double r : {r1, r2, r1 * std::cos(elevation_limit_rad), r2 * std::cos(elevation_limit_rad)}) {
    add_cosine((r * r + tangent2) / (2 * r * axis_m), azimuth_rad, kinks);
  }
  const auto density = [&](double psi) {
    return cylinder_density(radius_m, axis_m, elevation_limit_rad, psi - azimuth_rad, r1, r2);
  };
  return kinked_integral(density, psi_from, psi_to, kinks);
}

double WallEndTruth::beam(double psi_from, double psi_to, double r1, double r2) const {
  const double h = wall.altitude_m, top = wall.altitude_m - wall.wall_height_m, x = wall.wall_m;
  const PlaneTruth bed{h, 0, 0, -1, wall.elevation_limit_rad};
  std::vector<double> kinks{end_rad};
  for (const double r : {r1, r2}) {
    add_cosine(x / r, 0, kinks);                             // the wall at the height of the sonar,
    add_cosine(x / std::sqrt(r * r - h * h), 0, kinks);      // its foot,
    add_cosine(x / std::sqrt(r * r - top * top), 0, kinks);  // its top,
    add_cosine(x / (r * std::cos(wall.elevation_limit_rad)), 0, kinks);  // its exit from the fan,
    const double scaled = r * top / h;
    add_cosine(x / std::sqrt(scaled * scaled - top * top), 0, kinks);  // the far end of its shadow
  }
  const auto density = [&](double psi) {
    return psi > end_rad && std::abs(psi) < right_angle ? wall.density(psi, r1, r2)
                                                        : bed.density(psi, r1, r2);
  };
  return kinked_integral(density, psi_from, psi_to, kinks);
}

}  // namespace sonard::test
