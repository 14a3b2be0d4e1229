// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/coplanar_facets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

#include <glm/geometric.hpp>

namespace sonard::render {

namespace {

using Index = std::uint32_t;
using Triangle = std::array<Index, 3>;

constexpr Index none = ~Index{0};
constexpr double least_quality =
    1e-4;  // height over longest side: in thinner triangles the normal is mostly rounding error

/// The mesh with one vertex per position, even if the file repeats positions.
struct Welded {
  std::vector<glm::vec3> positions;
  std::vector<Triangle> triangles;  ///< triangles with three different corners
};

struct PlaceHash {
  std::size_t operator()(const std::array<std::uint32_t, 3>& bits) const {
    std::uint64_t h = bits[0] * 0x9E3779B97F4A7C15ULL;
    h = (h ^ (h >> 32) ^ bits[1]) * 0xC2B2AE3D27D4EB4FULL;
    h = (h ^ (h >> 32) ^ bits[2]) * 0x165667B19E3779F9ULL;
    return static_cast<std::size_t>(h ^ (h >> 29));
  }
};

Welded weld(const TriangleMesh& mesh) {
  Welded out;
  std::unordered_map<std::array<std::uint32_t, 3>, Index, PlaceHash> number_of;
  number_of.reserve(mesh.positions.size());
  std::vector<Index> number(mesh.positions.size());
  for (std::size_t i = 0; i < number.size(); ++i) {
    const glm::vec3 place = mesh.positions[i] + 0.0F;  // -0 becomes 0
    std::array<std::uint32_t, 3> bits;
    std::memcpy(bits.data(), &place, sizeof bits);
    const auto [at, is_new] = number_of.try_emplace(bits, static_cast<Index>(out.positions.size()));
    if (is_new) {
      out.positions.push_back(place);
    }
    number[i] = at->second;
  }
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Triangle t{number[mesh.indices[i]], number[mesh.indices[i + 1]], number[mesh.indices[i + 2]]};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) {
      out.triangles.push_back(t);
    }
  }
  return out;
}

/// Vertices whose facets have at most two directions: only these can be removed.
std::vector<Index> vertices_between_two_directions(const Welded& mesh) {
  struct Directions {
    glm::vec3 seen[2];
    int count = 0;
  };
  constexpr int many = 3;
  std::vector<Directions> of_vertex(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    const glm::vec3 a = mesh.positions[t[0]];
    const glm::vec3 normal = glm::normalize(glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a));
    for (const Index corner : t) {
      Directions& known = of_vertex[corner];
      const auto is_new = [&](const glm::vec3& n) {
        return !(glm::length(normal - n) < static_cast<float>(4 * flat_rad));
      };
      if (known.count < many && std::all_of(known.seen, known.seen + known.count, is_new)) {
        known.seen[std::min(known.count, 1)] = normal;
        ++known.count;
      }
    }
  }
  std::vector<Index> found;
  for (Index v = 0; v < of_vertex.size(); ++v) {
    if (of_vertex[v].count == 1 || of_vertex[v].count == 2) {
      found.push_back(v);
    }
  }
  return found;
}

/// Removes vertices by moving each onto one of its neighbours (half-edge collapse). Computes in doubles,
/// because it takes differences of float positions.
class FacetMerger {
 public:
  explicit FacetMerger(Welded mesh);
  TriangleMesh merged(std::vector<Index> candidates);

 private:
  struct Plane {
    glm::dvec3 normal;
    double distance;
  };
  /// The neighbours of a vertex in the order in which its triangles go around it.
  struct Ring {
    std::vector<Index> neighbours;
    std::vector<Index> triangles;  ///< triangle i lies between neighbours i and i + 1
    bool closed = true;            ///< else there is one more neighbour than triangles
  };

  glm::dvec3 at(Index vertex) const { return glm::dvec3(mesh_.positions[vertex]); }
  glm::dvec3 cross_of(const Triangle& t) const {
    return glm::cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0]));
  }
  bool in_plane(const Triangle& t, const Plane& plane) const;
  void list_triangles();
  void find_planes();
  void grow_plane(Index seed);
  std::optional<Ring> ring_of(Index vertex) const;
  std::vector<Index> targets(Index vertex, const Ring& ring) const;
  double bend_at(Index before, Index vertex, Index after) const;
  double worst_quality(Index target, const Ring& ring) const;
  bool keeps_manifold(Index vertex, Index target, const Ring& ring) const;
  void note_movement(Index before, Index vertex, Index after);
  bool take_out(Index vertex);
  void pass(std::vector<Index>& candidates);

  Welded mesh_;
  double tolerance_m_;
  std::vector<std::vector<Index>> triangles_of_;  ///< of each vertex
  std::vector<Index> plane_of_;                   ///< of each triangle; none: removed, or without area
  std::vector<Plane> planes_;
  std::vector<double> moved_m_;       ///< largest possible movement so far of edges at a vertex
  std::vector<std::uint8_t> locked_;  ///< vertices with a change beside them in this pass
};

FacetMerger::FacetMerger(Welded mesh) : mesh_(std::move(mesh)) {
  float farthest = 0.0F;
  for (const glm::vec3& p : mesh_.positions) {
    farthest = std::max({farthest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  tolerance_m_ = flat_m + static_cast<double>(farthest) * 0x1p-23;
}

bool FacetMerger::in_plane(const Triangle& t, const Plane& plane) const {
  const glm::dvec3 cross = cross_of(t);
  const double along = glm::dot(cross, plane.normal);
  // Compares the sine of the angle between the normals: at most 1e-4 rad.
  if (!(along > 0) || glm::length(cross - plane.normal * along) > flat_rad * along) {
    return false;
  }
  return std::all_of(t.begin(), t.end(), [&](Index corner) {
    return std::abs(glm::dot(plane.normal, at(corner)) - plane.distance) <= tolerance_m_;
  });
}

void FacetMerger::list_triangles() {
  triangles_of_.resize(mesh_.positions.size());
  for (Index t = 0; t < mesh_.triangles.size(); ++t) {
    for (const Index corner : mesh_.triangles[t]) {
      triangles_of_[corner].push_back(t);
    }
  }
}

void FacetMerger::find_planes() {
  plane_of_.assign(mesh_.triangles.size(), none);
  for (Index t = 0; t < mesh_.triangles.size(); ++t) {
    if (plane_of_[t] == none) {
      grow_plane(t);
    }
  }
}

/// The plane of one triangle and of all connected triangles in that plane. All are compared with the seed, so
/// that a surface of many small bends does not count as flat.
void FacetMerger::grow_plane(Index seed) {
  const glm::dvec3 cross = cross_of(mesh_.triangles[seed]);
  const double length = glm::length(cross);
  if (!(length > 0)) {
    return;
  }
  const auto number = static_cast<Index>(planes_.size());
  const Plane plane{cross / length, glm::dot(cross / length, at(mesh_.triangles[seed][0]))};
  planes_.push_back(plane);
  plane_of_[seed] = number;
  std::vector<Index> edge{seed};
  while (!edge.empty()) {
    const Triangle t = mesh_.triangles[edge.back()];
    edge.pop_back();
    for (const Index corner : t) {
      for (const Index next : triangles_of_[corner]) {
        if (plane_of_[next] == none && in_plane(mesh_.triangles[next], plane)) {
          plane_of_[next] = number;
          edge.push_back(next);
        }
      }
    }
  }
}

/// nullopt if the surface around the vertex is not a disc or half a disc.
std::optional<FacetMerger::Ring> FacetMerger::ring_of(Index vertex) const {
  const std::vector<Index>& around = triangles_of_[vertex];
  constexpr std::size_t most = 64;
  if (around.empty() || around.size() > most) {
    return std::nullopt;
  }
  std::array<Index, most> from{}, to{};  // of the side opposite the vertex
  for (std::size_t i = 0; i < around.size(); ++i) {
    const Triangle& t = mesh_.triangles[around[i]];
    const std::size_t k = t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
    from[i] = t[(k + 1) % 3];
    to[i] = t[(k + 2) % 3];
  }
  const auto end = from.begin() + static_cast<std::ptrdiff_t>(around.size());
  const auto first = std::find_if(from.begin(), end, [&](Index neighbour) {
    const auto to_end = to.begin() + static_cast<std::ptrdiff_t>(around.size());
    return std::find(to.begin(), to_end, neighbour) == to_end;
  });
  Ring ring;
  ring.closed = first == end;
  auto next = ring.closed ? from.begin() : first;
  while (next != end && ring.triangles.size() < around.size()) {
    const auto i = static_cast<std::size_t>(next - from.begin());
    ring.neighbours.push_back(from[i]);
    ring.triangles.push_back(around[i]);
    const Index last = to[i];
    next = std::find(from.begin(), end, last);
    if (next == end || ring.triangles.size() == around.size()) {
      if (ring.closed != (last == ring.neighbours.front())) {
        return std::nullopt;
      }
      if (!ring.closed) {
        ring.neighbours.push_back(last);
      }
      break;
    }
  }
  std::vector<Index> sorted = ring.neighbours;
  std::sort(sorted.begin(), sorted.end());
  const bool repeats = std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
  return ring.triangles.size() == around.size() && !repeats ? std::optional(std::move(ring)) : std::nullopt;
}

/// Distance of a vertex from the straight line between two others; infinite if it is not between them.
double FacetMerger::bend_at(Index before, Index vertex, Index after) const {
  const glm::dvec3 whole = at(after) - at(before);
  const glm::dvec3 part = at(vertex) - at(before);
  const double length = glm::length(whole);
  const double along = glm::dot(part, whole) / length;
  return along > 0 && along < length ? glm::length(glm::cross(part, whole)) / length
                                     : std::numeric_limits<double>::infinity();
}

/// The neighbours onto which the vertex can move without moving an edge between planes or a border.
std::vector<Index> FacetMerger::targets(Index vertex, const Ring& ring) const {
  std::vector<Index> ends;  // neighbours at which edges or borders leave the vertex
  const std::size_t count = ring.triangles.size();
  if (!ring.closed) {
    ends = {ring.neighbours.front(), ring.neighbours.back()};
  }
  for (std::size_t i = ring.closed ? 0 : 1; i < count; ++i) {
    const Index before = ring.triangles[(i + count - 1) % count];
    if (plane_of_[ring.triangles[i]] == none) {
      return {};
    }
    if (plane_of_[before] != plane_of_[ring.triangles[i]]) {
      ends.push_back(ring.neighbours[i]);
    }
  }
  if (ends.empty()) {
    return ring.neighbours;
  }
  const bool straight =
      ends.size() == 2 && moved_m_[vertex] + bend_at(ends[0], vertex, ends[1]) <= tolerance_m_;
  return straight ? ends : std::vector<Index>{};
}

/// Smallest height over longest side of the remaining triangles. Negative: not possible.
double FacetMerger::worst_quality(Index target, const Ring& ring) const {
  double worst = 1.0;
  for (std::size_t i = 0; i < ring.triangles.size(); ++i) {
    const Index a = ring.neighbours[i];
    const Index b = ring.neighbours[(i + 1) % ring.neighbours.size()];
    if (a == target || b == target) {
      continue;
    }
    const Triangle t{target, a, b};
    if (!in_plane(t, planes_[plane_of_[ring.triangles[i]]])) {
      return -1.0;
    }
    const double longest = std::max(
        {glm::length(at(a) - at(target)), glm::length(at(b) - at(target)), glm::length(at(b) - at(a))});
    worst = std::min(worst, glm::length(cross_of(t)) / (longest * longest));
  }
  return worst >= least_quality ? worst : -1.0;
}

/// Whether the two vertices share only the neighbours at their common edge; else two sheets would be joined.
bool FacetMerger::keeps_manifold(Index vertex, Index target, const Ring& ring) const {
  std::size_t shared = 0;
  std::vector<Index> seen;
  for (const Index t : triangles_of_[target]) {
    for (const Index corner : mesh_.triangles[t]) {
      if (corner != target && corner != vertex && std::find(seen.begin(), seen.end(), corner) == seen.end()) {
        seen.push_back(corner);
        const bool both =
            std::find(ring.neighbours.begin(), ring.neighbours.end(), corner) != ring.neighbours.end();
        shared += both ? 1 : 0;
      }
    }
  }
  const bool at_border =
      !ring.closed && (target == ring.neighbours.front() || target == ring.neighbours.back());
  return shared == (at_border ? 1 : 2);
}

/// When a vertex is removed, the edge from `before` to `after` is off by the vertex's distance and its
/// earlier movement. Both ends store the sum, so that small bends do not add up to a large one.
void FacetMerger::note_movement(Index before, Index vertex, Index after) {
  const double moved = moved_m_[vertex] + bend_at(before, vertex, after);
  moved_m_[before] = std::max(moved_m_[before], moved);
  moved_m_[after] = std::max(moved_m_[after], moved);
}

bool FacetMerger::take_out(Index vertex) {
  const std::optional<Ring> ring = ring_of(vertex);
  if (!ring) {
    return false;
  }
  Index best = none;
  double best_quality = 0.0;
  const std::vector<Index> choices = targets(vertex, *ring);
  for (const Index target : choices) {
    const double quality = worst_quality(target, *ring);
    if (quality > best_quality && keeps_manifold(vertex, target, *ring)) {
      best = target;
      best_quality = quality;
    }
  }
  if (best == none) {
    return false;
  }
  if (choices.size() == 2) {  // inside a plane there are more choices
    note_movement(choices[0], vertex, choices[1]);
  }
  for (const Index t : ring->triangles) {
    Triangle& corners = mesh_.triangles[t];
    if (std::find(corners.begin(), corners.end(), best) != corners.end()) {
      plane_of_[t] = none;
      for (const Index corner : corners) {
        std::erase(triangles_of_[corner], t);
      }
      corners = {0, 0, 0};
    } else {
      std::replace(corners.begin(), corners.end(), vertex, best);
      triangles_of_[best].push_back(t);
    }
  }
  triangles_of_[vertex].clear();
  for (const Index neighbour : ring->neighbours) {
    locked_[neighbour] = 1;
  }
  return true;
}

/// Neighbours of removed vertices wait for the next pass, so that the remaining vertices are evenly spread.
void FacetMerger::pass(std::vector<Index>& candidates) {
  locked_.assign(mesh_.positions.size(), 0);
  std::erase_if(candidates, [this](Index v) { return locked_[v] == 0 && take_out(v); });
}

TriangleMesh FacetMerger::merged(std::vector<Index> candidates) {
  list_triangles();
  find_planes();
  moved_m_.assign(mesh_.positions.size(), 0.0);
  for (std::size_t before = 0; before != candidates.size();) {
    before = candidates.size();
    pass(candidates);
  }
  TriangleMesh out;
  std::vector<Index> number(mesh_.positions.size(), none);
  for (const Triangle& t : mesh_.triangles) {
    if (t[0] == t[1]) {
      continue;
    }
    for (const Index corner : t) {
      if (number[corner] == none) {
        number[corner] = static_cast<Index>(out.positions.size());
        out.positions.push_back(mesh_.positions[corner]);
      }
      out.indices.push_back(number[corner]);
    }
  }
  return out;
}

}  // namespace

TriangleMesh merge_coplanar_facets(const TriangleMesh& mesh) {
  constexpr std::size_t least_share = 64;  // of the vertices; merging fewer is not worth the time
  Welded welded = weld(mesh);
  std::vector<Index> candidates = vertices_between_two_directions(welded);
  if (candidates.size() < welded.positions.size() / least_share) {
    TriangleMesh same;
    same.positions = mesh.positions;
    same.indices = mesh.indices;
    return same;
  }
  return FacetMerger(std::move(welded)).merged(std::move(candidates));
}

}  // namespace sonard::render
