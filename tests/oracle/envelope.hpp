// SPDX-License-Identifier: Apache-2.0
// Which of many line segments in a half-plane is seen from its origin, exactly.
#pragma once

#include <cstdint>
#include <vector>

namespace sonard::oracle {

/// A segment in a vertical half-plane through the sonar, in the coordinates in which sight is linear: tangent
/// of the elevation t = z / rho, and closeness w = 1 / rho. A straight segment in (rho, z) is straight here,
/// and of two surfaces at the same t the one with the larger w is seen.
struct Sightline {
  double t_begin, t_end;  ///< t_begin < t_end
  double w_begin, w_slope;
  std::uint32_t facet;

  double closeness(double t) const { return w_begin + w_slope * (t - t_begin); }
};

/// Part of a segment that is seen.
struct VisiblePiece {
  double t_begin, t_end;
  std::uint32_t sightline;  ///< index
};

/// Computes upper envelopes; keeps its buffers between calls. One thread uses one.
class Envelope {
 public:
  /// What is seen, ordered by t, without overlap. Of coinciding segments the one with the lower index is
  /// seen. The result is valid until the next call.
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
