// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/primitives.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace sonard::render {
namespace {

/// A cylinder is off by one sagitta. A sphere patch adds one per direction, so each gets half of the 2 mm.
constexpr double sagitta_m = 1e-3;
constexpr int min_segments = 48;
constexpr int max_segments = 512;

void require_extent(double value, const char* what) {
  if (!std::isfinite(value) || value < 0.0) {
    throw WorldError(fmt::format("{} is {}: expected a number >= 0", what, value));
  }
}

void require_size(double value, const char* what) {
  require_extent(value, what);
  if (value == 0.0) {
    throw ShapeOfNothing(fmt::format("{} is 0", what));
  }
}

std::uint32_t add_vertex(TriangleMesh& mesh, const glm::dvec3& position, const glm::dvec3& normal,
                         const glm::dvec2& uv) {
  mesh.positions.emplace_back(position);
  mesh.normals.emplace_back(normal);
  mesh.texcoords.emplace_back(uv);
  return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

void add_triangle(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh.indices.insert(mesh.indices.end(), {a, b, c});
}

/// Rectangle by centre and half sides; its normal is `half_u` x `half_v`.
void add_rectangle(TriangleMesh& mesh, const glm::dvec3& centre, const glm::dvec3& half_u,
                   const glm::dvec3& half_v) {
  const glm::dvec3 normal = glm::normalize(glm::cross(half_u, half_v));
  const std::uint32_t a = add_vertex(mesh, centre - half_u - half_v, normal, {0.0, 0.0});
  const std::uint32_t b = add_vertex(mesh, centre + half_u - half_v, normal, {1.0, 0.0});
  const std::uint32_t c = add_vertex(mesh, centre + half_u + half_v, normal, {1.0, 1.0});
  const std::uint32_t d = add_vertex(mesh, centre - half_u + half_v, normal, {0.0, 1.0});
  add_triangle(mesh, a, b, c);
  add_triangle(mesh, a, c, d);
}

/// cos and sin of step i of n; exact at the axes, so that mirrored shapes have mirrored bits.
glm::dvec2 on_circle(int i, int n) {
  const int quarter = n / 4;
  const int rest = i % quarter;
  const double angle = 2.0 * std::numbers::pi * rest / n;
  const double c = std::cos(angle);
  const double s = rest == 0 ? 0.0 : std::sin(angle);
  switch ((i / quarter) % 4) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    default:
      return {s, -c};
  }
}

/// One ring of a surface of revolution about z.
struct Ring {
  double radius;
  double z;
  glm::dvec2 normal;  ///< outward and z components, unit length
  double v;
};

/// Joins rings from bottom to top. The seam is doubled for the texture coordinates; rings of radius 0 are
/// poles.
void add_revolution(TriangleMesh& mesh, const std::vector<Ring>& rings, int n) {
  std::uint32_t below = 0;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const Ring& ring = rings[r];
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int i = 0; i <= n; ++i) {
      const glm::dvec2 dir = on_circle(i % n, n);
      add_vertex(mesh, {ring.radius * dir.x, ring.radius * dir.y, ring.z},
                 {ring.normal.x * dir.x, ring.normal.x * dir.y, ring.normal.y},
                 {static_cast<double>(i) / n, ring.v});
    }
    for (std::uint32_t i = 0; r > 0 && i < static_cast<std::uint32_t>(n); ++i) {
      if (rings[r - 1].radius > 0.0) {
        add_triangle(mesh, below + i, below + i + 1, first + i + 1);
      }
      if (ring.radius > 0.0) {
        add_triangle(mesh, below + i, first + i + 1, first + i);
      }
    }
    below = first;
  }
}

void add_disc(TriangleMesh& mesh, double radius, double z, int n) {
  const double up = z > 0.0 ? 1.0 : -1.0;
  const std::uint32_t centre = add_vertex(mesh, {0.0, 0.0, z}, {0.0, 0.0, up}, {0.5, 0.5});
  for (int i = 0; i < n; ++i) {
    const glm::dvec2 dir = on_circle(i, n);
    add_vertex(mesh, {radius * dir.x, radius * dir.y, z}, {0.0, 0.0, up},
               {0.5 + 0.5 * dir.x, 0.5 + 0.5 * up * dir.y});
  }
  for (int i = 0; i < n; ++i) {
    const std::uint32_t here = centre + 1 + static_cast<std::uint32_t>(i);
    const std::uint32_t next = centre + 1 + static_cast<std::uint32_t>((i + 1) % n);
    add_triangle(mesh, centre, up > 0.0 ? here : next, up > 0.0 ? next : here);
  }
}

/// A cylinder or a cone of length 0.
TriangleMesh make_disc(double radius_m) {
  TriangleMesh mesh;
  add_disc(mesh, radius_m, 0.0, segments_around(radius_m));
  return mesh;
}

/// Rings of a half sphere; `from` and `to` are latitude steps of n / 4 per quarter.
void add_latitudes(std::vector<Ring>& rings, double radius, double centre_z, int n, int from, int to) {
  for (int i = from; i <= to; ++i) {
    const glm::dvec2 dir = on_circle((i + n) % n, n);
    const double across = std::abs(i) == n / 4 ? 0.0 : dir.x;
    rings.push_back({radius * across, centre_z + radius * dir.y, {across, dir.y}, 0.0});
  }
}

/// Sets v proportional to the length along the profile.
void spread_texture(std::vector<Ring>& rings) {
  double length = 0.0;
  for (std::size_t i = 1; i < rings.size(); ++i) {
    length += std::hypot(rings[i].radius - rings[i - 1].radius, rings[i].z - rings[i - 1].z);
    rings[i].v = length;
  }
  for (Ring& ring : rings) {
    ring.v /= length;
  }
}

}  // namespace

int segments_around(double radius_m) {
  const double cosine = std::max(-1.0, 1.0 - sagitta_m / radius_m);
  const double needed = std::numbers::pi / std::acos(cosine);
  const int n = static_cast<int>(std::ceil(std::min(needed, static_cast<double>(max_segments)) / 4.0)) * 4;
  return std::clamp(n, min_segments, max_segments);
}

TriangleMesh make_box(const glm::dvec3& size_m) {
  require_extent(size_m.x, "box size");
  require_extent(size_m.y, "box size");
  require_extent(size_m.z, "box size");
  if (std::max({std::min(size_m.x, size_m.y), std::min(size_m.y, size_m.z), std::min(size_m.x, size_m.z)}) ==
      0.0) {
    throw ShapeOfNothing("two sides of the box are 0");
  }
  const glm::dvec3 x(0.5 * size_m.x, 0.0, 0.0);
  const glm::dvec3 y(0.0, 0.5 * size_m.y, 0.0);
  const glm::dvec3 z(0.0, 0.0, 0.5 * size_m.z);
  TriangleMesh mesh;
  const glm::dvec3 none(0.0);
  const auto add_faces = [&](const glm::dvec3& out, const glm::dvec3& u, const glm::dvec3& v) {
    if (u == none || v == none) {
      return;
    }
    add_rectangle(mesh, out, u, v);
    if (out != none) {
      add_rectangle(mesh, -out, -u, v);
    }
  };
  add_faces(x, y, z);
  add_faces(y, -x, z);
  add_faces(z, x, y);
  return mesh;
}

TriangleMesh make_sphere(double radius_m) {
  require_size(radius_m, "radius");
  const int n = segments_around(radius_m);
  std::vector<Ring> rings;
  add_latitudes(rings, radius_m, 0.0, n, -n / 4, n / 4);
  spread_texture(rings);
  TriangleMesh mesh;
  add_revolution(mesh, rings, n);
  return mesh;
}

TriangleMesh make_ellipsoid(const glm::dvec3& radii_m) {
  require_size(radii_m.x, "ellipsoid radius");
  require_size(radii_m.y, "ellipsoid radius");
  require_size(radii_m.z, "ellipsoid radius");
  const double largest = std::max({radii_m.x, radii_m.y, radii_m.z});
  TriangleMesh mesh = make_sphere(largest);
  const glm::dvec3 scale = radii_m / largest;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.positions[i] = glm::vec3(glm::dvec3(mesh.positions[i]) * scale);
    mesh.normals[i] = glm::vec3(glm::normalize(glm::dvec3(mesh.normals[i]) / scale));
  }
  return mesh;
}

TriangleMesh make_cylinder(double radius_m, double length_m) {
  require_size(radius_m, "radius");
  require_extent(length_m, "length");
  if (length_m == 0.0) {
    return make_disc(radius_m);
  }
  const int n = segments_around(radius_m);
  const double half = 0.5 * length_m;
  TriangleMesh mesh;
  add_revolution(mesh, {{radius_m, -half, {1.0, 0.0}, 0.0}, {radius_m, half, {1.0, 0.0}, 1.0}}, n);
  add_disc(mesh, radius_m, half, n);
  add_disc(mesh, radius_m, -half, n);
  return mesh;
}

TriangleMesh make_cone(double radius_m, double length_m) {
  require_size(radius_m, "radius");
  require_extent(length_m, "length");
  if (length_m == 0.0) {
    return make_disc(radius_m);
  }
  const int n = segments_around(radius_m);
  const double half = 0.5 * length_m;
  const glm::dvec2 normal = glm::normalize(glm::dvec2(length_m, radius_m));
  TriangleMesh mesh;
  add_revolution(mesh, {{radius_m, -half, normal, 0.0}, {0.0, half, normal, 1.0}}, n);
  add_disc(mesh, radius_m, -half, n);
  return mesh;
}

TriangleMesh make_capsule(double radius_m, double length_m) {
  require_size(radius_m, "radius");
  require_extent(length_m, "length");
  if (length_m == 0.0) {
    return make_sphere(radius_m);
  }
  const int n = segments_around(radius_m);
  std::vector<Ring> rings;
  add_latitudes(rings, radius_m, -0.5 * length_m, n, -n / 4, 0);
  add_latitudes(rings, radius_m, 0.5 * length_m, n, 0, n / 4);
  spread_texture(rings);
  TriangleMesh mesh;
  add_revolution(mesh, rings, n);
  return mesh;
}

TriangleMesh make_plane(const glm::dvec2& size_m, const glm::dvec3& normal) {
  require_size(size_m.x, "plane size");
  require_size(size_m.y, "plane size");
  const double length = glm::length(normal);
  if (!std::isfinite(length) || length <= 0.0) {
    throw WorldError("plane normal has no direction");
  }
  const glm::dvec3 up = normal / length;
  // Shortest turn from z. Straight down it is ambiguous, so the code turns about x.
  const glm::dquat turn = up.z < -1.0 + 1e-12 ? glm::dquat(0.0, 1.0, 0.0, 0.0)
                                              : glm::normalize(glm::dquat(1.0 + up.z, -up.y, up.x, 0.0));
  TriangleMesh mesh;
  add_rectangle(mesh, glm::dvec3(0.0), turn * glm::dvec3(0.5 * size_m.x, 0.0, 0.0),
                turn * glm::dvec3(0.0, 0.5 * size_m.y, 0.0));
  return mesh;
}

}  // namespace sonard::render
