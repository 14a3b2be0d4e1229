// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/slices/shells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

namespace sonard::render {

namespace {

// A sonar this near to a box or an outline counts as within it: places are floats.
constexpr float margin_m = 1e-3F;
constexpr double same_place = 1e-6;
// Boundary corners on a straight line may be out of it by this share of the outline's length.
constexpr double straight = 1e-6;

struct Edge {
  std::uint32_t low, high;  ///< numbers of its corners
  std::uint32_t triangle;
  bool rising;  ///< the triangle runs along it from low to high
};

/// Sets of triangles that grow together.
class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }

  std::uint32_t of(std::uint32_t i) {
    while (parent_[i] != i) {
      i = parent_[i] = parent_[parent_[i]];
    }
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[of(a)] = of(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Gives vertices in one place one number. Seams of generated meshes differ by rounding, so places as near as
/// `same_place` of the largest extent are one.
class Welder {
 public:
  explicit Welder(const std::vector<glm::vec3>& positions) : positions_(positions) {
    glm::vec3 high_m(std::numeric_limits<float>::lowest());
    for (const glm::vec3& p : positions) {
      low_m_ = glm::min(low_m_, p);
      high_m = glm::max(high_m, p);
    }
    const glm::dvec3 extent_m(high_m - low_m_);
    near_m_ = same_place * std::max({extent_m.x, extent_m.y, extent_m.z, 1e-30});
    first_in_cell_.reserve(positions.size());
  }

  /// The number of the first vertex in the place of each.
  std::vector<std::uint32_t> run() {
    std::vector<std::uint32_t> number(positions_.size());
    for (std::uint32_t i = 0; i < positions_.size(); ++i) {
      const std::optional<std::uint32_t> known = first_near(i);
      number[i] = known.value_or(i);
      if (!known) {
        first_in_cell_.emplace(key(cell(i, 0.0)), i);
      }
    }
    return number;
  }

 private:
  using Cell = std::array<std::uint64_t, 3>;

  /// The cell of a vertex that is moved by `offset_m` along all axes. Cells are wide, so that few vertices
  /// are near to the border of theirs.
  Cell cell(std::uint32_t vertex, double offset_m) const {
    const glm::dvec3 at =
        (glm::dvec3(positions_[vertex]) - glm::dvec3(low_m_) + (offset_m + near_m_)) / (16 * near_m_);
    return {static_cast<std::uint64_t>(at.x), static_cast<std::uint64_t>(at.y),
            static_cast<std::uint64_t>(at.z)};
  }
  static std::uint64_t key(const Cell& cell) { return cell[0] << 42U | cell[1] << 21U | cell[2]; }

  std::optional<std::uint32_t> first_near(std::uint32_t vertex) const {
    const Cell low = cell(vertex, -near_m_), high = cell(vertex, near_m_);
    const auto near = static_cast<float>(near_m_);
    for (std::uint64_t x = low[0]; x <= high[0]; ++x) {
      for (std::uint64_t y = low[1]; y <= high[1]; ++y) {
        for (std::uint64_t z = low[2]; z <= high[2]; ++z) {
          const auto [begin, end] = first_in_cell_.equal_range(key({x, y, z}));
          for (auto known = begin; known != end; ++known) {
            if (glm::all(glm::lessThanEqual(glm::abs(positions_[known->second] - positions_[vertex]),
                                            glm::vec3(near)))) {
              return known->second;
            }
          }
        }
      }
    }
    return std::nullopt;
  }

  const std::vector<glm::vec3>& positions_;
  glm::vec3 low_m_{std::numeric_limits<float>::max()};
  double near_m_ = 0.0;
  std::unordered_multimap<std::uint64_t, std::uint32_t> first_in_cell_;
};

/// Edges in the order of their corners. Triangles without area are skipped.
std::vector<Edge> edges_of(const TriangleMesh& mesh, const std::vector<std::uint32_t>& number) {
  std::vector<Edge> edges;
  edges.reserve(mesh.indices.size());
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    std::array<std::uint32_t, 3> corner{};
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = number[mesh.indices[std::size_t{t} * 3 + k]];
    }
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) {
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = corner[k], b = corner[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), t, a < b});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return edges;
}

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// The outline of a bed, from its boundary edges in any order, as pairs of corners in the direction that
/// keeps the surface to the left; nullopt if they are not one convex loop.
std::optional<std::vector<glm::vec2>> convex_outline(
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges, const std::vector<glm::vec3>& positions) {
  std::sort(edges.begin(), edges.end());
  std::vector<glm::vec2> outline;
  std::uint32_t at = edges.front().first;
  do {
    const auto next = std::lower_bound(edges.begin(), edges.end(), std::pair(at, 0U));
    if (next == edges.end() || next->first != at || outline.size() == edges.size()) {
      return std::nullopt;
    }
    outline.emplace_back(positions[at]);
    at = next->second;
  } while (at != edges.front().first);
  if (outline.size() != edges.size() || outline.size() < 3) {
    return std::nullopt;
  }
  double length_m = 0, turned_rad = 0;
  const auto side = [&](std::size_t i) {
    return glm::dvec2(outline[(i + 1) % outline.size()]) - glm::dvec2(outline[i % outline.size()]);
  };
  for (std::size_t i = 0; i < outline.size(); ++i) {
    length_m += glm::length(side(i));
  }
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const glm::dvec2 a = side(i), b = side(i + 1);
    const double turn = cross(a, b);
    if (turn < -straight * length_m * (glm::length(a) + glm::length(b))) {
      return std::nullopt;
    }
    turned_rad += std::atan2(turn, glm::dot(a, b));
  }
  // Once around: an outline that winds twice covers places twice.
  return turned_rad < 7.0 ? std::optional(outline) : std::nullopt;
}

/// Properties of the surface that the triangles of one group form.
struct Surface {
  bool ends_badly = false;  ///< an edge of more than two triangles, or of two that wind against each other
  std::vector<std::pair<std::uint32_t, std::uint32_t>> boundary;  ///< edges of one triangle, as it runs
  double volume_m3 = 0.0;                    ///< six times the signed volume of a closed one
  glm::dvec3 origin_m{0.0};                  ///< a corner of the first triangle
  int rising = 0, falling = 0, upright = 0;  ///< triangles by the z of their normals
  glm::vec3 low_m{std::numeric_limits<float>::max()}, high_m{std::numeric_limits<float>::lowest()};

  void add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::dvec3 p(a), q(b), r(c);
    const glm::dvec3 origin = rising + falling + upright == 0 ? p : origin_m;
    origin_m = origin;
    volume_m3 += glm::dot(p - origin, glm::cross(q - origin, r - origin));
    const double up = cross(glm::dvec2(q - p), glm::dvec2(r - p));
    ++(up > 0 ? rising : up < 0 ? falling : upright);
    low_m = glm::min(low_m, glm::min(a, glm::min(b, c)));
    high_m = glm::max(high_m, glm::max(a, glm::max(b, c)));
  }

  std::optional<Shell> shell(const std::vector<glm::vec3>& positions) const {
    if (ends_badly) {
      return std::nullopt;
    }
    if (boundary.empty()) {
      return volume_m3 == 0
                 ? std::nullopt
                 : std::optional(Shell{Shell::Kind::closed, volume_m3 > 0 ? 1.0F : -1.0F, low_m, high_m, {}});
    }
    if (upright > 0 || (rising > 0 && falling > 0)) {
      return std::nullopt;
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> around = boundary;
    if (falling > 0) {
      std::ranges::for_each(around, [](auto& edge) { std::swap(edge.first, edge.second); });
    }
    auto outline = convex_outline(std::move(around), positions);
    return outline ? std::optional(Shell{Shell::Kind::bed, rising > 0 ? 1.0F : -1.0F, low_m, high_m,
                                         std::move(*outline)})
                   : std::nullopt;
  }
};

/// Calls take(edges) for the edges of each pair of corners.
template <class Take>
void each_edge(std::span<const Edge> edges, const Take& take) {
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].low == edges[begin].low && edges[end].high == edges[begin].high) {
      ++end;
    }
    take(edges.subspan(begin, end - begin));
  }
}

/// Triangles that share edges are one surface.
/// @return the number of its surface for each triangle, in the order of the mesh; Shells::none without area
std::vector<std::uint32_t> number_surfaces(std::size_t triangles, std::span<const Edge> edges) {
  Groups groups(triangles);
  std::vector<bool> has_area(triangles);
  each_edge(edges, [&](std::span<const Edge> same) {
    for (const Edge& edge : same) {
      groups.join(edge.triangle, same.front().triangle);
      has_area[edge.triangle] = true;
    }
  });
  std::vector<std::uint32_t> of_group(triangles, Shells::none), of_triangle(triangles, Shells::none);
  std::uint32_t count = 0;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    if (has_area[t]) {
      std::uint32_t& surface = of_group[groups.of(t)];
      surface = surface == Shells::none ? count++ : surface;
      of_triangle[t] = surface;
    }
  }
  return of_triangle;
}

}  // namespace

bool Shell::hides_inner_side(const glm::vec3& sonar_m) const {
  if (kind == Kind::closed) {
    return glm::any(glm::lessThan(sonar_m, low_m - margin_m)) ||
           glm::any(glm::greaterThan(sonar_m, high_m + margin_m));
  }
  if (sonar_m.z < high_m.z + margin_m) {
    return false;
  }
  for (std::size_t i = 0; i < footprint_m.size(); ++i) {
    const glm::dvec2 from(footprint_m[i]), to(footprint_m[(i + 1) % footprint_m.size()]);
    const double left = cross(to - from, glm::dvec2(sonar_m.x, sonar_m.y) - from);
    if (left < static_cast<double>(margin_m) * glm::length(to - from)) {
      return false;
    }
  }
  return true;
}

Shells::Shells(const TriangleMesh& mesh) {
  const std::vector<Edge> edges = edges_of(mesh, Welder(mesh.positions).run());
  shell_of_triangle_ = number_surfaces(mesh.triangle_count(), edges);
  std::vector<Surface> surfaces;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    if (const std::uint32_t s = shell_of_triangle_[t]; s != none) {
      surfaces.resize(std::max<std::size_t>(surfaces.size(), s + 1));
      const std::uint32_t* const corner = &mesh.indices[t * 3];
      surfaces[s].add(mesh.positions[corner[0]], mesh.positions[corner[1]], mesh.positions[corner[2]]);
    }
  }
  each_edge(edges, [&](std::span<const Edge> same) {
    const Edge& edge = same.front();
    Surface& surface = surfaces[shell_of_triangle_[edge.triangle]];
    if (same.size() == 1) {
      surface.boundary.emplace_back(edge.rising ? edge.low : edge.high, edge.rising ? edge.high : edge.low);
    } else if (same.size() > 2 || same[0].rising == same[1].rising) {
      surface.ends_badly = true;
    }
  });
  std::vector<std::uint32_t> shell_of_surface(surfaces.size(), none);
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    if (auto shell = surfaces[s].shell(mesh.positions)) {
      shell_of_surface[s] = static_cast<std::uint32_t>(shells_.size());
      shells_.push_back(std::move(*shell));
    }
  }
  for (std::uint32_t& number : shell_of_triangle_) {
    number = number == none ? none : shell_of_surface[number];
  }
}

}  // namespace sonard::render
