// SPDX-License-Identifier: Apache-2.0
#include "tests/scenes/shapes.hpp"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace sonard::test {

namespace {

using Index = std::uint32_t;

Index add_vertex(render::TriangleMesh& mesh, const glm::dvec3& position) {
  mesh.positions.emplace_back(position);
  return static_cast<Index>(mesh.positions.size() - 1);
}

/// A first and a last point, joined by rings of `around` vertices each. Rings are contiguous in the mesh.
/// Seen from the last point towards the first, they run counter-clockwise.
struct Rings {
  Index first, first_ring, last;
  int around, count;

  Index at(int ring, int step) const {
    return first_ring + static_cast<Index>(ring * around + step % around);
  }
};

void add_triangles(render::TriangleMesh& mesh, const Rings& rings) {
  for (int step = 0; step < rings.around; ++step) {
    mesh.indices.insert(mesh.indices.end(), {rings.first, rings.at(0, step + 1), rings.at(0, step)});
    for (int ring = 0; ring + 1 < rings.count; ++ring) {
      const Index a = rings.at(ring, step), b = rings.at(ring, step + 1);
      const Index c = rings.at(ring + 1, step + 1), d = rings.at(ring + 1, step);
      mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
    }
    const int end = rings.count - 1;
    mesh.indices.insert(mesh.indices.end(), {rings.last, rings.at(end, step), rings.at(end, step + 1)});
  }
}

}  // namespace

render::TriangleMesh make_block(const glm::dvec3& centre_m, const glm::dvec3& size_m, double yaw_rad) {
  render::TriangleMesh mesh;
  const glm::dvec3 u = size_m.x / 2 * glm::dvec3(std::cos(yaw_rad), std::sin(yaw_rad), 0);
  const glm::dvec3 v = size_m.y / 2 * glm::dvec3(-std::sin(yaw_rad), std::cos(yaw_rad), 0);
  const glm::dvec3 w(0, 0, size_m.z / 2);
  for (const double up : {-1.0, 1.0}) {  // corners 0..3 below, 4..7 above, counter-clockwise from above
    add_vertex(mesh, centre_m - u - v + up * w);
    add_vertex(mesh, centre_m + u - v + up * w);
    add_vertex(mesh, centre_m + u + v + up * w);
    add_vertex(mesh, centre_m - u + v + up * w);
  }
  mesh.indices = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7};
  for (Index side = 0; side < 4; ++side) {
    const Index next = (side + 1) % 4;
    mesh.indices.insert(mesh.indices.end(), {side, next, next + 4, side, next + 4, side + 4});
  }
  return mesh;
}

render::TriangleMesh make_ball(const glm::dvec3& centre_m, double radius_m, int around, int bands) {
  render::TriangleMesh mesh;
  Rings rings{add_vertex(mesh, centre_m - glm::dvec3(0, 0, radius_m)), 1, 0, around, bands - 1};
  for (int band = 1; band < bands; ++band) {
    const double polar = std::numbers::pi * band / bands;  // from the lower pole
    for (int step = 0; step < around; ++step) {
      const double azimuth = 2 * std::numbers::pi * step / around;
      add_vertex(mesh,
                 centre_m + radius_m * glm::dvec3(std::sin(polar) * std::cos(azimuth),
                                                  std::sin(polar) * std::sin(azimuth), -std::cos(polar)));
    }
  }
  rings.last = add_vertex(mesh, centre_m + glm::dvec3(0, 0, radius_m));
  add_triangles(mesh, rings);
  return mesh;
}

render::TriangleMesh make_tube(const glm::dvec3& from_m, const glm::dvec3& to_m, double radius_m, int around,
                               int along) {
  render::TriangleMesh mesh;
  const glm::dvec3 axis = glm::normalize(to_m - from_m);
  const glm::dvec3 aside = std::abs(axis.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(aside, axis));
  const glm::dvec3 v = glm::cross(axis, u);
  Rings rings{add_vertex(mesh, from_m), 1, 0, around, along + 1};
  for (int ring = 0; ring <= along; ++ring) {
    const glm::dvec3 centre = from_m + (to_m - from_m) * (static_cast<double>(ring) / along);
    for (int step = 0; step < around; ++step) {
      const double angle = 2 * std::numbers::pi * step / around;
      add_vertex(mesh, centre + radius_m * (std::cos(angle) * u + std::sin(angle) * v));
    }
  }
  rings.last = add_vertex(mesh, to_m);
  add_triangles(mesh, rings);
  return mesh;
}

void append(render::TriangleMesh& mesh, const render::TriangleMesh& part) {
  const auto offset = static_cast<Index>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
  mesh.indices.reserve(mesh.indices.size() + part.indices.size());
  for (const Index index : part.indices) {
    mesh.indices.push_back(index + offset);
  }
}

}  // namespace sonard::test
