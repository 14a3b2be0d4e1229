// SPDX-License-Identifier: Apache-2.0
// The oracle's own ray tracer over triangles, double precision, rays from the sonar only.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/oracle/facets.hpp"
#include "tests/oracle/surface.hpp"

namespace sonard::oracle {

/// Bounding volume hierarchy, split by the surface area heuristic. As all rays start at the origin, a ray
/// meets triangle ABC when it lies on one side of the three planes through the origin and its edges:
/// d.(A x B), d.(B x C), d.(C x A) have one sign. A x B and B x A are negatives of each other to the last
/// bit, so two triangles at one edge treat it alike and no ray slips between them.
/// Keeps a reference to the facets. Of two facets at the same range the one with the lower index is hit.
class Bvh : public Surface {
 public:
  explicit Bvh(const Facets& facets);

  SurfaceHit nearest(const glm::dvec3& direction) const override;

  /// Index of the facet hit first and the range, or -1.
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
  /// Leaf: `count` triangles from `first`. Inner: children at the next node and at `first`.
  struct Node {
    Box box;
    std::uint32_t first = 0;
    std::uint16_t count = 0;
    std::uint16_t axis = 0;
  };
  struct Triangle {
    glm::dvec3 edge_ab, edge_bc, edge_ca;  // normals of the planes through the origin and the edges
    double volume;                         // A.(B x C); over the sum of the three products: the range
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
