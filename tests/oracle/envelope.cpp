// SPDX-License-Identifier: Apache-2.0
#include "tests/oracle/envelope.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace sonard::oracle {

const std::vector<VisiblePiece>& Envelope::visible(const std::vector<Sightline>& sightlines) {
  sightlines_ = &sightlines;
  pieces_.clear();
  run_ends_.clear();
  for (std::uint32_t i = 0; i < sightlines.size(); ++i) {
    pieces_.push_back({sightlines[i].t_begin, sightlines[i].t_end, i});
    run_ends_.push_back(pieces_.size());
  }
  // Runs are envelopes. Neighbouring runs are merged until one is left.
  while (run_ends_.size() > 1) {
    merged_.clear();
    merged_ends_.clear();
    std::size_t begin = 0;
    for (std::size_t run = 0; run < run_ends_.size(); run += 2) {
      const std::size_t end_b = run + 1 < run_ends_.size() ? run_ends_[run + 1] : run_ends_[run];
      merge(begin, run_ends_[run], end_b);
      merged_ends_.push_back(merged_.size());
      begin = end_b;
    }
    std::swap(pieces_, merged_);
    std::swap(run_ends_, merged_ends_);
  }
  return pieces_;
}

/// Merges the envelopes [begin_a, end_a) and [end_a, end_b) of `pieces_`, and appends the result to
/// `merged_`.
void Envelope::merge(std::size_t begin_a, std::size_t end_a, std::size_t end_b) {
  constexpr double never = std::numeric_limits<double>::infinity();
  const std::size_t run_begin = merged_.size();
  std::size_t a = begin_a;
  std::size_t b = end_a;
  double t = -never;
  while (a < end_a || b < end_b) {
    const double a_begin = a < end_a ? pieces_[a].t_begin : never;
    const double b_begin = b < end_b ? pieces_[b].t_begin : never;
    t = std::max(t, std::min(a_begin, b_begin));
    const bool in_a = a_begin <= t;
    const bool in_b = b_begin <= t;
    const double end = std::min(in_a ? pieces_[a].t_end : a_begin, in_b ? pieces_[b].t_end : b_begin);
    if (in_a && in_b) {
      put_nearer(t, end, pieces_[a].sightline, pieces_[b].sightline, run_begin);
    } else {
      put(t, end, pieces_[in_a ? a : b].sightline, run_begin);
    }
    t = end;
    a += in_a && pieces_[a].t_end <= t ? 1 : 0;
    b += in_b && pieces_[b].t_end <= t ? 1 : 0;
  }
}

void Envelope::put(double t_begin, double t_end, std::uint32_t sightline, std::size_t run_begin) {
  if (!(t_end > t_begin)) {
    return;
  }
  if (merged_.size() > run_begin && merged_.back().sightline == sightline &&
      merged_.back().t_end == t_begin) {
    merged_.back().t_end = t_end;
  } else {
    merged_.push_back({t_begin, t_end, sightline});
  }
}

void Envelope::put_nearer(double t_begin, double t_end, std::uint32_t a, std::uint32_t b,
                          std::size_t run_begin) {
  const Sightline& line_a = (*sightlines_)[a];
  const Sightline& line_b = (*sightlines_)[b];
  const double lead_begin = line_a.closeness(t_begin) - line_b.closeness(t_begin);
  const double lead_end = line_a.closeness(t_end) - line_b.closeness(t_end);
  const std::uint32_t first = lead_begin > 0 || (lead_begin == 0 && lead_end >= 0) ? a : b;
  const std::uint32_t last = lead_end > 0 || (lead_end == 0 && lead_begin >= 0) ? a : b;
  if (first == last) {
    put(t_begin, t_end, first, run_begin);
    return;
  }
  const double crossing =
      std::clamp(t_begin + (t_end - t_begin) * (lead_begin / (lead_begin - lead_end)), t_begin, t_end);
  put(t_begin, crossing, first, run_begin);
  put(crossing, t_end, last, run_begin);
}

}  // namespace sonard::oracle
