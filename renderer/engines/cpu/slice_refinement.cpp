// SPDX-License-Identifier: Apache-2.0
// Refinement of slices: comparison of neighbours, and division.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "renderer/engines/cpu/slice_sampler_impl.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

constexpr std::size_t borders_per_job = 32;

/// Compares neighbours (renderer/engines/slices/refine.glsl).
struct Comparison {
  const SideView& view;
  float most_sagitta_m;
  float divided_anyway;  ///< share of mismatch above which shift_lines() is not needed

  SliceBorder operator()(const SliceCell& port, const SliceCell& starboard) const;

 private:
  /// @param port_side, starboard_side profiles that the two expect on the border
  SliceBorder compare(const SliceCell& port, const SideProfile& port_side, const SideProfile& starboard_side,
                      const SliceCell& starboard) const;
  float shift_lines(const SideProfile& port_side, const SideProfile& starboard_side) const;
};

SliceBorder Comparison::operator()(const SliceCell& port, const SliceCell& starboard) const {
  if (port.edge_at_starboard.none()) {
    return compare(port, port.sides.starboard, starboard.sides.port, starboard);
  }
  // Probes along the edge are ignored: there the surfaces differ.
  SideProfile port_side = port.sides.starboard, starboard_side = starboard.sides.port;
  for (std::size_t i = 0; i < side_probes; ++i) {
    if (port.edge_at_starboard[i]) {
      port_side[i] = starboard_side[i] = 0.0F;
    }
  }
  return compare(port, port_side, starboard_side, starboard);
}

SONARD_SIMD_CLONES
SliceBorder Comparison::compare(const SliceCell& port, const SideProfile& port_side,
                                const SideProfile& starboard_side, const SliceCell& starboard) const {
  const float* __restrict pp = port.sides.port.data();
  const float* __restrict ps = port_side.data();
  const float* __restrict sp = starboard_side.data();
  const float* __restrict ss = starboard.sides.starboard.data();
  const float* __restrict secant = view.secant.data();
  const std::int32_t* __restrict weight = view.weight.data();
  const float mean_width = 0.5F * (port.slice.width_rad + starboard.slice.width_rad);
  const slices::BorderLimits limits{view.line_m, view.bins_end_m, most_sagitta_m,
                                    mean_width / (8 * port.slice.width_rad),
                                    mean_width / (8 * starboard.slice.width_rad)};
  std::int32_t mismatched = 0, curved = 0;
  for (std::size_t i = 0; i < side_probes; ++i) {
    const slices::ProbeDisagreement probe =
        slices::compare_probe({pp[i], ps[i], sp[i], ss[i], secant[i], weight[i]}, limits);
    mismatched += probe.mismatched;
    curved += probe.curved;
  }
  const float mismatch = static_cast<float>(mismatched) / (side_probes * probe_weight_unit);
  return {mismatch, static_cast<float>(curved) / (side_probes * probe_weight_unit),
          mismatch > 0 && mismatch < divided_anyway ? shift_lines(port_side, starboard_side) : 0.0F};
}

/// One number per probe.
using OfProbes = std::array<float, side_probes>;

/// Sum in sixteen lanes, two AVX2 vectors of eight, because the compiler does not reorder float sums.
SONARD_SIMD_CLONES
float sum(const OfProbes& numbers) {
  constexpr std::size_t lanes = 8;
  static_assert(side_probes % (2 * lanes) == 0);
  using Lanes = float __attribute__((vector_size(lanes * sizeof(float))));
  Lanes lower{}, upper{};
  for (std::size_t i = 0; i < side_probes; i += 2 * lanes) {
    Lanes some;
    std::memcpy(&some, &numbers[i], sizeof some);
    lower += some;
    std::memcpy(&some, &numbers[i + lanes], sizeof some);
    upper += some;
  }
  float all = 0.0F;
  for (std::size_t k = 0; k < lanes; ++k) {
    all += lower[k];
  }
  for (std::size_t k = 0; k < lanes; ++k) {
    all += upper[k];
  }
  return all;
}

SONARD_SIMD_CLONES
float Comparison::shift_lines(const SideProfile& port_side, const SideProfile& starboard_side) const {
  const float* __restrict wa = port_side.data();
  const float* __restrict wb = starboard_side.data();
  const float* __restrict secant = view.secant.data();
  const std::int32_t* __restrict weight = view.weight.data();
  const float line_m = view.line_m, furthest_m = view.bins_end_m;
  const float probes_per_t = (side_probes - 1) / (2 * slices::probe_reach * view.tan_limit);
  const auto moment_of = [&](float w, float next_w, std::size_t i, float pattern) {
    return slices::moment_of(w, next_w, secant[i], secant[i + 1], furthest_m, probes_per_t, pattern);
  };
  OfProbes echo, moment, error, error_moment;
  for (std::size_t i = 0; i < side_probes; ++i) {
    const float a = wa[i], b = wb[i], scale = secant[i];
    const float pattern = static_cast<float>(weight[i]) / probe_weight_unit;
    const float moment_a = moment_of(a, wa[i + 1], i, pattern), echo_a = moment_a * a;
    const float moment_b = moment_of(b, wb[i + 1], i, pattern), echo_b = moment_b * b;
    const float nearer = a > b ? a : b;
    const float difference = scale * (a > b ? a - b : b - a);
    const bool mismatched = (scale < furthest_m * nearer) & (difference > line_m * (a * b));
    echo[i] = echo_a + echo_b;
    moment[i] = moment_a + moment_b;
    error[i] = mismatched ? echo_a - echo_b : 0.0F;
    error_moment[i] = mismatched ? moment_a - moment_b : 0.0F;
  }
  const float all = sum(echo);
  return all > 0 ? std::abs(sum(error_moment) - sum(error) * (sum(moment) / all)) / (0.5F * all * line_m)
                 : 0.0F;
}

}  // namespace

/// Compares only pairs with a new slice.
void SliceSampler::compare_neighbours(const Setting& setting) {
  const std::size_t borders = order_.size() - 1;
  workers_.run(static_cast<int>((borders + borders_per_job - 1) / borders_per_job), [&](int job) {
    const std::size_t begin = static_cast<std::size_t>(job) * borders_per_job;
    for (std::size_t i = begin; i < std::min(borders, begin + borders_per_job); ++i) {
      SliceCell& port = *cells_[order_[i]];
      const SliceCell& starboard = *cells_[order_[i + 1]];
      if (!port.fresh && !starboard.fresh) {
        continue;
      }
      const float lines = std::max(1.0F, std::min(port.sides.lines, starboard.sides.lines));
      const float narrower = std::min(setting.share_of_beam(port), setting.share_of_beam(starboard));
      const Comparison compare{setting.side_view, setting.accuracy.sagitta_lines * lines * setting.line_m,
                               setting.accuracy.disagreement / narrower};
      port.to_starboard = compare(port, starboard);
    }
  });
}

/// Per beam, the share of elevations at which it receives an echo.
std::vector<float> SliceSampler::ensonified_by_beam(const Setting& setting) const {
  std::vector<float> ensonified(static_cast<std::size_t>(setting.fan.beam_count()), 0.0F);
  for (const std::size_t i : order_) {
    const SliceCell& cell = *cells_[i];
    ensonified[static_cast<std::size_t>(cell.beam)] += setting.share_of_beam(cell) * cell.sides.ensonified;
  }
  for (float& share : ensonified) {
    share = std::max(share, slices::least_ensonified);
  }
  return ensonified;
}

/// Per beam, the effective number of slices that share its error: weighted by squares, so that one slice much
/// worse than the others counts alone.
std::vector<float> SliceSampler::slices_in_error(const Setting& setting) const {
  const auto beams = static_cast<std::size_t>(setting.fan.beam_count());
  std::vector<float> squares(beams, 0.0F), fourths(beams, 0.0F);
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const SliceCell& cell = *cells_[order_[i]];
    const float port = i > 0 ? cells_[order_[i - 1]]->to_starboard.range_mismatch : 0.0F;
    const float error = setting.share_of_beam(cell) * std::max(port, cell.to_starboard.range_mismatch);
    const auto b = static_cast<std::size_t>(cell.beam);
    squares[b] += error * error;
    fourths[b] += error * error * error * error;
  }
  for (std::size_t b = 0; b < beams; ++b) {
    squares[b] = fourths[b] > 0 ? squares[b] * squares[b] / fourths[b] : 1.0F;
  }
  return squares;
}

/// Number of parts into which each slice must be divided (slices::parts_of_slice).
std::vector<int> SliceSampler::choose_parts(const Setting& setting) {
  compare_neighbours(setting);
  const std::vector<float> ensonified = ensonified_by_beam(setting);
  const std::vector<float> in_error = slices_in_error(setting);
  const SliceAccuracy& accuracy = setting.accuracy;
  const slices::DivisionLimits limits{accuracy.most_divisions, accuracy.most_divisions_of_lone_echoes,
                                      accuracy.disagreement, accuracy.shift_lines};
  std::vector<int> parts(order_.size(), 1);
  for (std::size_t i = 0; i < order_.size(); ++i) {
    SliceCell& cell = *cells_[order_[i]];
    cell.fresh = false;
    const SliceBorder port = i > 0 ? cells_[order_[i - 1]]->to_starboard : SliceBorder{};
    const SliceBorder starboard = cell.to_starboard;
    const auto beam = static_cast<std::size_t>(cell.beam);
    parts[i] = slices::parts_of_slice({.share_of_beam = setting.share_of_beam(cell),
                                       .beam_ensonified = ensonified[beam],
                                       .beam_in_error = in_error[beam],
                                       .mismatch = std::max(port.range_mismatch, starboard.range_mismatch),
                                       .curvature = std::max(port.curvature, starboard.curvature),
                                       .shift_lines = std::max(port.shift_lines, starboard.shift_lines),
                                       .ensonified = cell.sides.ensonified,
                                       .one_sided = cell.sides.one_sided,
                                       .missed_share = cell.missed_share},
                                      limits);
  }
  return parts;
}

/// Puts the parts of a slice into `order` and `fresh`: cut at upright edges if there are any, else even
/// parts.
void SliceSampler::divide(std::size_t whole_number, int parts, std::vector<std::size_t>& order,
                          std::vector<std::size_t>& fresh) {
  const SliceCell& whole = *cells_[whole_number];  // stays valid while cells are added
  const auto width = static_cast<double>(whole.slice.width_rad);
  const double port_rad = whole.slice.azimuth_rad + 0.5 * width;
  const bool at_edges = !whole.edges.empty();
  if (at_edges) {
    parts = static_cast<int>(whole.edges.size()) + 1;
  }
  double from = port_rad;
  for (int k = 0; k < parts; ++k) {
    const bool last = k + 1 == parts;
    const auto next = static_cast<std::size_t>(k);
    const double to = at_edges && !last ? whole.edges[next].azimuth_rad : port_rad - width * (k + 1) / parts;
    fresh.push_back(new_cell({0.5 * (from + to), static_cast<float>(from - to)}, whole.beam));
    order.push_back(fresh.back());
    SliceCell& part = *cells_[fresh.back()];
    part.edge_at_starboard = last       ? whole.edge_at_starboard
                             : at_edges ? whole.edges[next].probes
                                        : ProbeSet();
    if (!at_edges && 2 * k + 1 == parts) {
      part.visible.swap(cells_[whole_number]->visible);
      part.seen = true;
    }
    from = to;
  }
}

/// @return true if any slice was divided; `fresh` gets the new cells
bool SliceSampler::refine(const Setting& setting, std::vector<std::size_t>& fresh) {
  fresh.clear();
  if (setting.accuracy.most_divisions == 1) {
    return false;
  }
  const std::vector<int> parts = choose_parts(setting);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < order_.size(); ++i) {
    if (parts[i] == 1) {
      order.push_back(order_[i]);
    } else {
      divide(order_[i], parts[i], order, fresh);
    }
  }
  order_.swap(order);
  return !fresh.empty();
}

}  // namespace sonard::render
