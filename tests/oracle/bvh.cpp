// SPDX-License-Identifier: Apache-2.0
#include "tests/oracle/bvh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <glm/geometric.hpp>

namespace sonard::oracle {

namespace {
constexpr std::size_t leaf_size = 4;
constexpr std::size_t split_bins = 16;
constexpr std::size_t deepest = 256;  // stack size of find(); trees stay far below it
constexpr double never = std::numeric_limits<double>::infinity();
}  // namespace

void Bvh::Box::add(const glm::dvec3& point) {
  low = glm::min(low, point);
  high = glm::max(high, point);
}

void Bvh::Box::add(const Box& box) {
  low = glm::min(low, box.low);
  high = glm::max(high, box.high);
}

double Bvh::Box::half_area() const {
  const glm::dvec3 size = glm::max(high - low, glm::dvec3(0));
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

/// Builds nodes depth first. Permutes `order` so that each leaf is a contiguous part of it.
struct Bvh::Builder {
  const std::vector<Box>& boxes;
  std::vector<std::uint32_t>& order;
  std::vector<Node>& nodes;

  glm::dvec3 centre(std::uint32_t i) const { return 0.5 * (boxes[i].low + boxes[i].high); }

  void build(std::size_t begin, std::size_t end) {
    const std::size_t index = nodes.size();
    nodes.emplace_back();
    Box bounds;
    Box centres;
    for (std::size_t i = begin; i < end; ++i) {
      bounds.add(boxes[order[i]]);
      centres.add(centre(order[i]));
    }
    nodes[index].box = bounds;
    if (end - begin <= leaf_size) {
      nodes[index].first = static_cast<std::uint32_t>(begin);
      nodes[index].count = static_cast<std::uint16_t>(end - begin);
      return;
    }
    const glm::dvec3 size = centres.high - centres.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const std::size_t middle = split(begin, end, axis, centres);
    nodes[index].axis = static_cast<std::uint16_t>(axis);
    build(begin, middle);
    nodes[index].first = static_cast<std::uint32_t>(nodes.size());
    build(middle, end);
  }

  /// Orders [begin, end) along `axis` around the cheapest of some equally spaced cuts. @return the cut
  std::size_t split(std::size_t begin, std::size_t end, int axis, const Box& centres) {
    const double low = centres.low[axis];
    const double scale = static_cast<double>(split_bins) / (centres.high[axis] - low);
    const auto first = order.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = order.begin() + static_cast<std::ptrdiff_t>(end);
    const auto bin_of = [&](std::uint32_t i) {
      return std::min(static_cast<std::size_t>((centre(i)[axis] - low) * scale), split_bins - 1);
    };
    if (std::isfinite(scale)) {
      const std::size_t cut = cheapest_cut(first, last, bin_of);
      const auto middle = std::partition(first, last, [&](std::uint32_t i) { return bin_of(i) < cut; });
      if (middle != first && middle != last) {
        return static_cast<std::size_t>(middle - order.begin());
      }
    }
    return begin + (end - begin) / 2;  // all centres coincide
  }

  template <class Iterator, class BinOf>
  std::size_t cheapest_cut(Iterator first, Iterator last, BinOf bin_of) const {
    std::array<Box, split_bins> bin_box;
    std::array<std::size_t, split_bins> bin_count{};
    for (Iterator i = first; i != last; ++i) {
      bin_box[bin_of(*i)].add(boxes[*i]);
      ++bin_count[bin_of(*i)];
    }
    std::array<double, split_bins> cost{};
    const auto sweep = [&](auto bin_at, auto cut_of) {
      Box box;
      std::size_t count = 0;
      for (std::size_t i = 0; i + 1 < split_bins; ++i) {
        box.add(bin_box[bin_at(i)]);
        count += bin_count[bin_at(i)];
        cost[cut_of(i)] += count > 0 ? box.half_area() * static_cast<double>(count) : 0.0;
      }
    };
    sweep([](std::size_t i) { return i; }, [](std::size_t i) { return i + 1; });
    sweep([](std::size_t i) { return split_bins - 1 - i; }, [](std::size_t i) { return split_bins - 1 - i; });
    return static_cast<std::size_t>(std::min_element(cost.begin() + 1, cost.end()) - cost.begin());
  }
};

Bvh::Bvh(const Facets& facets) : facets_(facets) {
  const std::vector<Facet>& all = facets.all();
  if (all.empty()) {
    return;
  }
  std::vector<Box> boxes(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const glm::dvec3& corner : all[i].corners) {
      boxes[i].add(corner);
    }
  }
  std::vector<std::uint32_t> order(all.size());
  std::iota(order.begin(), order.end(), 0U);
  nodes_.reserve(all.size());
  Builder{boxes, order, nodes_}.build(0, all.size());
  triangles_.reserve(all.size());
  for (const std::uint32_t i : order) {
    const auto& [a, b, c] = all[i].corners;
    const glm::dvec3 bc = glm::cross(b, c);
    triangles_.push_back({glm::cross(a, b), bc, glm::cross(c, a), glm::dot(a, bc), i});
  }
}

/// @return the range at which the ray enters the box; infinity if it misses the box or enters beyond `limit`
double Bvh::enter(const Box& box, const glm::dvec3& inverse_direction, double limit) {
  const glm::dvec3 a = box.low * inverse_direction;
  const glm::dvec3 b = box.high * inverse_direction;
  const glm::dvec3 near = glm::min(a, b);
  const glm::dvec3 far = glm::max(a, b);
  const double in = std::max(0.0, std::max(near.x, std::max(near.y, near.z)));
  const double out = std::min(far.x, std::min(far.y, far.z));
  constexpr double slack = 1e-12;  // tolerates rounding if a triangle touches the box
  return in * (1 - slack) <= out * (1 + slack) && in * (1 - slack) <= limit ? in : never;
}

void Bvh::meet(const Triangle& triangle, const glm::dvec3& direction, Found& nearest) {
  const double ab = glm::dot(triangle.edge_ab, direction);
  const double bc = glm::dot(triangle.edge_bc, direction);
  const double ca = glm::dot(triangle.edge_ca, direction);
  const bool inside = (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
  const double sum = ab + bc + ca;
  if (!inside || sum == 0) {
    return;
  }
  const double range = triangle.volume / sum;
  const bool is_first =
      range < nearest.range_m || (range == nearest.range_m && std::int64_t{triangle.facet} < nearest.facet);
  if (range > 0 && is_first) {
    nearest = {triangle.facet, range};
  }
}

Bvh::Found Bvh::find(const glm::dvec3& direction) const {
  Found nearest;
  if (nodes_.empty()) {
    return nearest;
  }
  constexpr double tiny = 1e-200;  // a zero would give 0 * infinity for boxes through the origin
  const auto invert = [](double x) { return 1 / (std::abs(x) > tiny ? x : std::copysign(tiny, x)); };
  const glm::dvec3 inverse(invert(direction.x), invert(direction.y), invert(direction.z));
  std::array<std::uint32_t, deepest> waiting;
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const std::uint32_t index = waiting[--count];
    const Node& node = nodes_[index];
    if (enter(node.box, inverse, nearest.range_m) == never) {
      continue;
    }
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        meet(triangles_[i], direction, nearest);
      }
      continue;
    }
    const bool backwards = direction[node.axis] < 0;
    waiting.at(count++) = backwards ? index + 1 : node.first;
    waiting.at(count++) = backwards ? node.first : index + 1;
  }
  return nearest;
}

SurfaceHit Bvh::nearest(const glm::dvec3& direction) const {
  const Found found = find(direction);
  if (found.facet < 0) {
    return {};
  }
  const Facet& facet = facets_.all()[static_cast<std::size_t>(found.facet)];
  return {found.range_m, facet.normal, facets_.shading_normal(facet, found.range_m * direction),
          facets_.material(facet)};
}

}  // namespace sonard::oracle
