// SPDX-License-Identifier: Apache-2.0
// The echo of one vertical half-plane through the sonar: exact visibility, piecewise integration in
// elevation.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tests/oracle/echo_law.hpp"
#include "tests/oracle/envelope.hpp"
#include "tests/oracle/facets.hpp"

namespace sonard::oracle {

/// Echo per range line, of one slice or the sum of several.
struct LineSums {
  std::vector<double> echo;    ///< per radian of azimuth
  std::vector<double> weight;  ///< mode `paper`: pattern times solid angle per radian; else empty

  explicit LineSums(const EchoLaw& law)
      : echo(static_cast<std::size_t>(law.lines()), 0.0),
        weight(law.is_mean() ? static_cast<std::size_t>(law.lines()) : 0, 0.0) {}
};

/// Cuts the facets at one azimuth, finds the visible parts of the cuts and integrates them over elevation.
/// Cuts are straight, and their visible parts are exact (Envelope). Along each part the range is a hyperbola
/// that crosses the line edges at points in closed form. So there is no sampling in elevation or range, and
/// no footprint. Keeps buffers: use one per thread.
class Slicer {
 public:
  Slicer(const Facets& facets, const EchoLaw& law);

  /// Adds the echo per radian at azimuth `psi_rad` to `sums`. Only `candidates` (indices of facets) are used;
  /// they may include facets that do not meet the half-plane.
  void add(double psi_rad, std::span<const std::uint32_t> candidates, LineSums& sums);

 private:
  struct Cut;
  void cut(std::uint32_t index);
  void add_piece(const VisiblePiece& piece, LineSums& sums) const;
  void add_branch(const Cut& cut, double side, double from, double to, LineSums& sums) const;
  void add_panel(const Cut& cut, double from, double to, std::size_t line, LineSums& sums) const;

  const Facets& facets_;
  const EchoLaw& law_;
  double tan_limit_;
  double cos_psi_ = 1.0, sin_psi_ = 0.0;
  std::vector<Sightline> sightlines_;
  Envelope envelope_;
};

}  // namespace sonard::oracle
