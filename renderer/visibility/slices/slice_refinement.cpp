// Where slices have to be narrower.
#include <algorithm>
#include <cmath>

#include "renderer/simd.hpp"
#include "renderer/visibility/slices/slice_sampler_impl.hpp"

namespace sonard::render {

namespace {

// Odd, so that the part in the middle goes on with what the whole has seen. An edge is closed in on, a bow
// falls with the square of the width.
constexpr int parts_at_edges = 5;
constexpr int parts_of_bows = 3;
constexpr float bows_per_edge = 10.0F;  // what a bow displaces stays nearby, what an edge hides is gone
constexpr float ends_per_edge = 1.0F;   // where the range ends, the smear of a slice is right in first order
constexpr std::size_t borders_per_job = 32;
constexpr float least_heard = 0.5F / side_probes;

/// Compares neighbours. Ranges are secant / w: compared without dividing, and without those out of range in
/// both.
struct Comparison {
  float line_m, bow_m, furthest_m;

  SliceBorder operator()(const SliceCell& port, const SliceCell& starboard, const SideProfile& secant) const;

 private:
  /// @param port_side, starboard_side what the two expect on the border.
  SliceBorder compare(const SliceCell& port, const SideProfile& port_side, const SideProfile& starboard_side,
                      const SliceCell& starboard, const SideProfile& secant) const;
};

SliceBorder Comparison::operator()(const SliceCell& port, const SliceCell& starboard,
                                   const SideProfile& secant) const {
  if (port.edge_at_starboard.none()) {
    return compare(port, port.sides.starboard, starboard.sides.port, starboard, secant);
  }
  // Along the edge they have every reason to disagree.
  SideProfile port_side = port.sides.starboard, starboard_side = starboard.sides.port;
  for (std::size_t i = 0; i < side_probes; ++i) {
    if (port.edge_at_starboard[i]) {
      port_side[i] = starboard_side[i] = 0.0F;
    }
  }
  return compare(port, port_side, starboard_side, starboard, secant);
}

SONARD_SIMD_CLONES
SliceBorder Comparison::compare(const SliceCell& port, const SideProfile& port_side,
                                const SideProfile& starboard_side, const SliceCell& starboard,
                                const SideProfile& secant) const {
  const float* __restrict pp = port.sides.port.data();
  const float* __restrict ps = port_side.data();
  const float* __restrict sp = starboard_side.data();
  const float* __restrict ss = starboard.sides.starboard.data();
  // A bow over a chord of width b is b^2 / 8 of the curvature, here the change of slope over the mean width.
  const float mean_width = 0.5F * (port.slice.width_rad + starboard.slice.width_rad);
  const float per_port = mean_width / (8 * port.slice.width_rad);
  const float per_starboard = mean_width / (8 * starboard.slice.width_rad);
  std::int32_t apart = 0, bent = 0;
  for (std::size_t i = 0; i < side_probes; ++i) {
    const float w_a = ps[i], w_b = sp[i], scale = secant[i];
    const float nearer = w_a > w_b ? w_a : w_b;
    const float product = w_a * w_b;
    const float difference = scale * (w_a > w_b ? w_a - w_b : w_b - w_a);
    const float bow = scale * std::abs((pp[i] - w_a) * per_port - (w_b - ss[i]) * per_starboard);
    const bool all_seen = (pp[i] > 0) & (product > 0) & (ss[i] > 0);
    const bool in_range = scale < furthest_m * nearer;
    apart += (in_range & (difference > line_m * product)) ? 1 : 0;
    const float displaced = bow > difference ? bow : difference;
    bent += (in_range & all_seen & (displaced > bow_m * product)) ? 1 : 0;
  }
  return {static_cast<float>(apart) / side_probes, static_cast<float>(bent) / side_probes};
}

}  // namespace

/// Fills `borders_`. One between two slices that were compared before needs no second look.
void SliceSampler::compare_neighbours(const Setting& setting) {
  borders_.resize(order_.size());
  const std::size_t borders = order_.size() - 1;
  workers_.run(static_cast<int>((borders + borders_per_job - 1) / borders_per_job), [&](int job) {
    const std::size_t begin = static_cast<std::size_t>(job) * borders_per_job;
    for (std::size_t i = begin; i < std::min(borders, begin + borders_per_job); ++i) {
      const SliceCell& port = *cells_[order_[i]];
      const SliceCell& starboard = *cells_[order_[i + 1]];
      if (!port.fresh && !starboard.fresh) {
        borders_[i] = {};
        continue;
      }
      const float lines = std::max(1.0F, std::min(port.sides.lines, starboard.sides.lines));
      const Comparison compare{setting.line_m, setting.accuracy.bow_lines * lines * setting.line_m,
                               setting.side_view.max_range_m};
      borders_[i] = compare(port, starboard, setting.side_view.secant);
    }
  });
}

/// At which share of its elevations each beam hears anything.
std::vector<float> SliceSampler::heard_by_beams(const Setting& setting) const {
  std::vector<float> heard(static_cast<std::size_t>(setting.fan.beam_count()), 0.0F);
  for (const std::size_t i : order_) {
    const SliceCell& cell = *cells_[i];
    heard[static_cast<std::size_t>(cell.beam)] += setting.share_of_beam(cell) * cell.sides.heard;
  }
  for (float& share : heard) {
    share = std::max(share, least_heard);
  }
  return heard;
}

/// Into how many parts each slice is to be divided: those on both sides of every border at which they
/// disagree too much, those that miss something thin, those in which the range ends, and those across which
/// the echo of facets changes too much. All is measured by what the beam hears.
std::vector<int> SliceSampler::choose_parts(const Setting& setting) {
  compare_neighbours(setting);
  const std::vector<float> heard = heard_by_beams(setting);
  std::vector<int> parts(order_.size(), 1);
  for (std::size_t i = 0; i < order_.size(); ++i) {
    SliceCell& cell = *cells_[order_[i]];
    cell.fresh = false;
    const float width = setting.share_of_beam(cell);
    if (width * static_cast<float>(setting.accuracy.most_divisions) < 1.5F) {
      continue;
    }
    const SliceBorder port = i > 0 ? borders_[i - 1] : SliceBorder{};
    const SliceBorder starboard = i + 1 < order_.size() ? borders_[i] : SliceBorder{};
    const float most = setting.accuracy.disagreement * heard[static_cast<std::size_t>(cell.beam)] / width;
    const float bent = std::max(port.bent, starboard.bent);
    const float ending =
        cell.sides.one_sided * cell.sides.one_sided / std::max(cell.sides.heard, least_heard);
    if (cell.misses_something || std::max(port.apart, starboard.apart) > most) {
      parts[i] = parts_at_edges;
    } else if (bent > bows_per_edge * most || ending > ends_per_edge * most || cell.blurs_facets) {
      parts[i] = parts_of_bows;
    }
  }
  return parts;
}

/// Puts the parts of a slice into `order` and `fresh`: at upright edges if there are any, else evenly.
void SliceSampler::divide(std::size_t whole_number, int parts, std::vector<std::size_t>& order,
                          std::vector<std::size_t>& fresh) {
  const SliceCell& whole = *cells_[whole_number];  // stays where it is while cells are added
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
      part.pieces.swap(cells_[whole_number]->pieces);
      part.seen = true;
    }
    from = to;
  }
}

/// @return whether anything was divided; `fresh` are the new cells.
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
