// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/plane_quadrature.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/kink_quadrature.hpp"

namespace sonard::bench {

namespace {

/// Adds the azimuths in (from, to) at which n.(cos psi, sin psi, 0) equals `horizontal`.
void add_azimuths(const test::PlaneTruth& plane, double horizontal, double from, double to,
                  std::vector<double>& kinks) {
  const double largest = std::hypot(plane.nx, plane.ny);
  if (!(std::abs(horizontal) < largest)) {
    return;
  }
  const double centre = std::atan2(plane.ny, plane.nx);
  const double aside = std::acos(horizontal / largest);
  for (const double turn : {-2 * std::numbers::pi, 0.0, 2 * std::numbers::pi}) {
    for (const double psi : {centre + aside + turn, centre - aside + turn}) {
      if (psi > from && psi < to) {
        kinks.push_back(psi);
      }
    }
  }
}

/// Azimuths at which range r meets the foot point, or the plane on an elevation limit.
void add_kinks(const test::PlaneTruth& plane, double r, double from, double to, std::vector<double>& kinks) {
  const double ratio = plane.distance_m / r;
  if (ratio >= std::abs(plane.nz)) {
    const double foot = std::sqrt(ratio * ratio - plane.nz * plane.nz);
    add_azimuths(plane, foot, from, to, kinks);
    add_azimuths(plane, -foot, from, to, kinks);
  }
  for (const double limit : {-plane.elevation_limit_rad, plane.elevation_limit_rad}) {
    add_azimuths(plane, (ratio - plane.nz * std::sin(limit)) / std::cos(limit), from, to, kinks);
  }
}

}  // namespace

double plane_beam_echo(const test::PlaneTruth& plane, double psi_from, double psi_to, double r1, double r2) {
  std::vector<double> kinks;
  add_kinks(plane, r1, psi_from, psi_to, kinks);
  add_kinks(plane, r2, psi_from, psi_to, kinks);
  return test::kinked_integral([&](double psi) { return plane.density(psi, r1, r2); }, psi_from, psi_to,
                               kinks);
}

}  // namespace sonard::bench
