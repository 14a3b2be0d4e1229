// SPDX-License-Identifier: Apache-2.0
// The oracle's own ray tracer for triangles: double precision, rays from the sonar only.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/oracle/facets.hpp"
#include "tests/oracle/surface.hpp"

namespace sonard::oracle {

/// Bounding volume hierarchy, split by the surface area heuristic. All rays start at the origin, so a ray
/// meets triangle ABC if it lies on one side of the three planes through the origin and its edges: d.(A x B),
/// d.(B x C), d.(C x A) have one sign. A x B and B x A are negatives of each other to the last bit. So two
/// triangles treat a common edge alike, and no ray passes between them. Keeps a reference to the facets. Of
/// two facets at the same range, the one with the lower index is hit.
class Bvh : public Surface {
 public:
  explicit Bvh(const Facets& facets);

  SurfaceHit nearest(const glm::dvec3& direction) const override;

  /// Index of the first facet hit (-1: no hit), and the range.
  struct Found {
    std::int64_t facet = -1;
    double range_m = std::numeric_limits<double>::infinity();
  };
  Found find(const glm::dvec3& direction) const;

 private:
  struct Box {
    glm::dvec3 low{std::numeric_limits<double>::infinity()};
    glm::dvec3 high{-std::numeric_limits<double>::infinity()};
    void add(const glm::dvec3& point);
    void add(const Box& box);
    double half_area() const;
  };
  /// A leaf has `count` triangles from `first`. The children of an inner node are the next node and node
  /// `first`.
  struct Node {
    Box box;
    std::uint32_t first = 0;
    std::uint16_t count = 0;
    std::uint16_t axis = 0;
  };
  struct Triangle {
    glm::dvec3 edge_ab, edge_bc, edge_ca;  // normals of the planes through the origin and the edges
    double volume;  // A.(B x C); divided by the sum of the three products, it is the range
    std::uint32_t facet;
  };
  struct Builder;

  static double enter(const Box& box, const glm::dvec3& inverse_direction, double limit);
  static void meet(const Triangle& triangle, const glm::dvec3& direction, Found& nearest);

  const Facets& facets_;
  std::vector<Node> nodes_;
  std::vector<Triangle> triangles_;
};

}  // namespace sonard::oracle
