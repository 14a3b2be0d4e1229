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

// Odd, so that the middle part keeps the visible segments of the whole. Five parts close in on an edge; for a
// sagitta, which falls with the square of the width, three do.
constexpr int parts_at_edges = 5;
constexpr int parts_of_curves = 3;
constexpr float three_helps_by = 9.0F;    // the error falls with the width, and its share of a beam once more
constexpr float curves_per_edge = 10.0F;  // a sagitta displaces echoes only a little, an edge hides them
constexpr float ends_per_edge = 1.0F;     // at the end of the range, smears are right in first order
constexpr std::size_t borders_per_job = 32;
constexpr float lone_share = 0.6F;  // of the elevations with an echo, at which neighbours disagree
constexpr float least_ensonified = 0.5F / side_probes;

/// Compares neighbours. Ranges are secant / w; they are compared without division, and ignored if both are
/// out of range.
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
  // A sagitta over a chord of width b is b^2 / 8 of the curvature, here the change of slope over the mean
  // width.
  const float* __restrict secant = view.secant.data();
  const std::int32_t* __restrict weight = view.weight.data();
  const float line_m = view.line_m, furthest_m = view.max_range_m, most_sagitta = most_sagitta_m;
  const float mean_width = 0.5F * (port.slice.width_rad + starboard.slice.width_rad);
  const float per_port = mean_width / (8 * port.slice.width_rad);
  const float per_starboard = mean_width / (8 * starboard.slice.width_rad);
  std::int32_t mismatched = 0, curved = 0;
  for (std::size_t i = 0; i < side_probes; ++i) {
    const float w_a = ps[i], w_b = sp[i], scale = secant[i];
    const float nearer = w_a > w_b ? w_a : w_b;
    const float product = w_a * w_b;
    const float difference = scale * (w_a > w_b ? w_a - w_b : w_b - w_a);
    const float sagitta = scale * std::abs((pp[i] - w_a) * per_port - (w_b - ss[i]) * per_starboard);
    const bool all_seen = (pp[i] > 0) & (product > 0) & (ss[i] > 0);
    const bool in_range = scale < furthest_m * nearer;
    mismatched += (in_range & (difference > line_m * product)) ? weight[i] : 0;
    const float displaced = sagitta > difference ? sagitta : difference;
    curved += (in_range & all_seen & (displaced > most_sagitta * product)) ? weight[i] : 0;
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

/// The echo of an elevation is proportional to cos(incidence) / r^2. With s the slope of the range along the
/// slice, from one probe to the next, the cosine is approximated as 1 / (1 + |s|): accurate enough as a
/// weight of errors, and without a root.
SONARD_SIMD_CLONES
float Comparison::shift_lines(const SideProfile& port_side, const SideProfile& starboard_side) const {
  const float* __restrict wa = port_side.data();
  const float* __restrict wb = starboard_side.data();
  const float* __restrict secant = view.secant.data();
  const std::int32_t* __restrict weight = view.weight.data();
  const float line_m = view.line_m, furthest_m = view.max_range_m;
  const float probes_per_t = (side_probes - 1) / (2 * static_cast<float>(probe_reach) * view.tan_limit);
  /// Echo times range.
  const auto moment_of = [&](float w, float next_w, float scale, float next_scale, float pattern) {
    constexpr float tiny = 1e-30F;                             // avoids 0 / 0 if nothing is seen
    const float here = next_scale * w, next = scale * next_w;  // proportional to the ranges there and here
    const float steps = here > next ? here - next : next - here;
    const float cosine = next / (next + steps * (probes_per_t * scale * scale) + tiny);
    return scale < furthest_m * w ? cosine * w * pattern : 0.0F;
  };
  OfProbes echo, moment, error, error_moment;
  for (std::size_t i = 0; i < side_probes; ++i) {
    const float a = wa[i], b = wb[i], scale = secant[i], next_scale = secant[i + 1];
    const float pattern = static_cast<float>(weight[i]) / probe_weight_unit;
    const float moment_a = moment_of(a, wa[i + 1], scale, next_scale, pattern), echo_a = moment_a * a;
    const float moment_b = moment_of(b, wb[i + 1], scale, next_scale, pattern), echo_b = moment_b * b;
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
    share = std::max(share, least_ensonified);
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

/// Number of parts into which each slice must be divided. Divided are slices on both sides of a border at
/// which they disagree too much, slices that miss a thin thing, and slices in which the range ends. Errors
/// are relative to the elevations at which the beam receives an echo, and add like independent errors.
std::vector<int> SliceSampler::choose_parts(const Setting& setting) {
  compare_neighbours(setting);
  const std::vector<float> ensonified = ensonified_by_beam(setting);
  const std::vector<float> in_error = slices_in_error(setting);
  std::vector<int> parts(order_.size(), 1);
  for (std::size_t i = 0; i < order_.size(); ++i) {
    SliceCell& cell = *cells_[order_[i]];
    cell.fresh = false;
    const float width = setting.share_of_beam(cell);
    const SliceBorder port = i > 0 ? cells_[order_[i - 1]]->to_starboard : SliceBorder{};
    const SliceBorder starboard = cell.to_starboard;
    const auto beam = static_cast<std::size_t>(cell.beam);
    const float mismatch = std::max(port.range_mismatch, starboard.range_mismatch);
    const float curvature = std::max(port.curvature, starboard.curvature);
    const bool lone = std::max(mismatch, curvature) > lone_share * ensonified[beam];
    const int most_divisions =
        lone ? setting.accuracy.most_divisions_of_lone_echoes : setting.accuracy.most_divisions;
    if (width * static_cast<float>(most_divisions) < 1.5F) {
      continue;
    }
    const float most = setting.accuracy.disagreement * ensonified[beam] / width;
    const float most_mismatch = most / std::sqrt(in_error[beam]);
    const bool shifted =
        std::max(port.shift_lines, starboard.shift_lines) * width > setting.accuracy.shift_lines;
    const float ending =
        cell.sides.one_sided * cell.sides.one_sided / std::max(cell.sides.ensonified, least_ensonified);
    if (cell.misses_something || mismatch > most_mismatch || shifted) {
      const bool is_first = width * static_cast<float>(setting.accuracy.slices_per_beam) > 0.9F;
      const bool three_will_do = !cell.misses_something && mismatch < three_helps_by * most_mismatch;
      parts[i] =
          three_will_do && !(is_first && setting.accuracy.first_in_five) ? parts_of_curves : parts_at_edges;
    } else if (curvature > curves_per_edge * most || ending > ends_per_edge * most) {
      parts[i] = parts_of_curves;
    }
  }
  return parts;
}

/// Puts the parts of a slice into `order` and `fresh`: cut at upright edges if there are any, else even
/// parts.
void SliceSampler::divide(std::size_t whole_number, int parts, std::vector<std::size_t>& order,
                          std::vector<std::size_t>& fresh) {
  const SliceCell& whole = *cells_[whole_number];  // stays valid while cells are added
  const double width = static_cast<double>(whole.slice.width_rad);
  const double port_rad = whole.slice.azimuth_rad + 0.5 * width;
  const bool at_edges = !whole.edges.empty();
  if (at_edges) {
    parts = static_cast<int>(whole.edges.size()) + 1;
  }
  double from = port_rad;
  ProbeSet edge = whole.edge_at_port;
  for (int k = 0; k < parts; ++k) {
    const bool last = k + 1 == parts;
    const auto next = static_cast<std::size_t>(k);
    const double to = at_edges && !last ? whole.edges[next].azimuth_rad : port_rad - width * (k + 1) / parts;
    fresh.push_back(new_cell({0.5 * (from + to), static_cast<float>(from - to)}, whole.beam));
    order.push_back(fresh.back());
    SliceCell& part = *cells_[fresh.back()];
    part.edge_at_port = edge;
    edge = last ? whole.edge_at_starboard : at_edges ? whole.edges[next].probes : ProbeSet();
    part.edge_at_starboard = edge;
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
