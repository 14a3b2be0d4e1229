// SPDX-License-Identifier: Apache-2.0
// Finds exactly which of many line segments in a half-plane are visible from its origin.
#pragma once

#include <cstdint>
#include <vector>

namespace sonard::oracle {

/// A segment in a vertical half-plane through the sonar. In these coordinates lines of sight are simple:
/// tangent of the elevation t = z / rho, and closeness w = 1 / rho. Straight segments in (rho, z) are
/// straight here too. Of two surfaces at the same t, the one with the larger w is visible.
struct Sightline {
  double t_begin, t_end;  ///< t_begin < t_end
  double w_begin, w_slope;
  std::uint32_t facet;

  double closeness(double t) const { return w_begin + w_slope * (t - t_begin); }
};

/// The visible part of a segment.
struct VisiblePiece {
  double t_begin, t_end;
  std::uint32_t sightline;  ///< index
};

/// Computes upper envelopes and keeps its buffers between calls. Use one per thread.
class Envelope {
 public:
  /// Returns the visible parts, ordered by t, without overlap. Of coinciding segments, the one with the lower
  /// index is visible. The result is valid until the next call.
  const std::vector<VisiblePiece>& visible(const std::vector<Sightline>& sightlines);

 private:
  void merge(std::size_t begin_a, std::size_t end_a, std::size_t end_b);
  void put(double t_begin, double t_end, std::uint32_t sightline, std::size_t run_begin);
  void put_nearer(double t_begin, double t_end, std::uint32_t a, std::uint32_t b, std::size_t run_begin);

  const std::vector<Sightline>* sightlines_ = nullptr;
  std::vector<VisiblePiece> pieces_, merged_;
  std::vector<std::size_t> run_ends_, merged_ends_;
};

}  // namespace sonard::oracle
