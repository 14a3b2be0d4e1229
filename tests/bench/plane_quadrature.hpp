// SPDX-License-Identifier: Apache-2.0
// Integrates the closed form of a plane over the width of a beam, fast and to a part in a million.
#pragma once

#include "tests/support/closed_forms.hpp"

namespace sonard::bench {

/// Echo of a beam between two azimuths from ranges [r1, r2), r1 > 0, as PlaneTruth::beam(). Along azimuth,
/// the density has kinks at which the plane enters or leaves the range line. The integral is split at the
/// kinks.
double plane_beam_echo(const test::PlaneTruth& plane, double psi_from, double psi_to, double r1, double r2);

}  // namespace sonard::bench
