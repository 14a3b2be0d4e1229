// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include <glm/geometric.hpp>

namespace sonard::render {
namespace {

constexpr double coordinate_limit_m = 1e12;
/// Twice the area of a triangle with 0.1 um sides; below it a float cross product has no reliable direction.
constexpr double min_cross_m2 = 1e-14;
/// Height over longest edge; below it three float positions count as collinear.
constexpr double min_relative_height = 1e-7;
constexpr float min_normal_length = 1e-6F;

enum class Verdict { good, degenerate, non_finite };

bool usable(const glm::vec3& p) {
  return std::abs(p.x) <= coordinate_limit_m && std::abs(p.y) <= coordinate_limit_m &&
         std::abs(p.z) <= coordinate_limit_m;  // also false for NaN
}

/// Normal of the triangle; its length is twice the area.
glm::dvec3 area_normal(const std::vector<glm::vec3>& positions, const std::uint32_t* corner) {
  const glm::dvec3 a(positions[corner[0]]);
  return glm::cross(glm::dvec3(positions[corner[1]]) - a, glm::dvec3(positions[corner[2]]) - a);
}

Verdict verdict_of(const std::vector<glm::vec3>& positions, const std::uint32_t* corner) {
  const glm::vec3& a = positions[corner[0]];
  const glm::vec3& b = positions[corner[1]];
  const glm::vec3& c = positions[corner[2]];
  if (!usable(a) || !usable(b) || !usable(c)) {
    return Verdict::non_finite;
  }
  if (a == b || b == c || c == a) {
    return Verdict::degenerate;
  }
  const double longest =
      std::max({glm::distance(glm::dvec3(a), glm::dvec3(b)), glm::distance(glm::dvec3(b), glm::dvec3(c)),
                glm::distance(glm::dvec3(c), glm::dvec3(a))});
  const double cross = glm::length(area_normal(positions, corner));
  return cross < min_cross_m2 || cross < min_relative_height * longest * longest ? Verdict::degenerate
                                                                                 : Verdict::good;
}

void check_shape(const TriangleMesh& mesh) {
  const auto fits = [&](std::size_t length) { return length == 0 || length == mesh.positions.size(); };
  if (!fits(mesh.normals.size()) || !fits(mesh.texcoords.size()) || !fits(mesh.tangents.size())) {
    throw WorldError("normals, texture coordinates or tangents do not match the number of positions");
  }
  if (mesh.indices.size() % 3 != 0) {
    throw WorldError("the number of indices is not a multiple of 3");
  }
  const auto out = std::find_if(mesh.indices.begin(), mesh.indices.end(),
                                [&](std::uint32_t index) { return index >= mesh.positions.size(); });
  if (out != mesh.indices.end()) {
    throw WorldError("vertex index " + std::to_string(*out) + " is out of range: there are " +
                     std::to_string(mesh.positions.size()) + " vertices");
  }
}

void drop_bad_triangles(TriangleMesh& mesh, MeshDiagnostics& diagnostics) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    switch (verdict_of(mesh.positions, &mesh.indices[i])) {
      case Verdict::degenerate:
        ++diagnostics.degenerate_triangles;
        break;
      case Verdict::non_finite:
        ++diagnostics.non_finite_triangles;
        break;
      case Verdict::good:
        std::copy_n(&mesh.indices[i], 3, &mesh.indices[kept]);
        kept += 3;
        break;
    }
  }
  mesh.indices.resize(kept);
}

template <typename T>
void keep_only(std::vector<T>& values, const std::vector<std::uint32_t>& old_of_new) {
  if (values.empty()) {
    return;
  }
  std::vector<T> kept;
  kept.reserve(old_of_new.size());
  for (const std::uint32_t old : old_of_new) {
    kept.push_back(values[old]);
  }
  values = std::move(kept);
}

/// Unused vertices may be NaN. After this, every position belongs to a valid triangle.
void drop_unused_vertices(TriangleMesh& mesh) {
  constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> new_of_old(mesh.positions.size(), unused);
  std::vector<std::uint32_t> old_of_new;
  for (std::uint32_t& index : mesh.indices) {
    std::uint32_t& slot = new_of_old[index];
    if (slot == unused) {
      slot = static_cast<std::uint32_t>(old_of_new.size());
      old_of_new.push_back(index);
    }
    index = slot;
  }
  keep_only(mesh.positions, old_of_new);
  keep_only(mesh.normals, old_of_new);
  keep_only(mesh.texcoords, old_of_new);
  keep_only(mesh.tangents, old_of_new);
}

std::vector<glm::dvec3> area_weighted_normals(const TriangleMesh& mesh) {
  std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0.0));
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::dvec3 normal = area_normal(mesh.positions, &mesh.indices[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      sums[mesh.indices[i + k]] += normal;
    }
  }
  return sums;
}

glm::vec3 any_perpendicular(const glm::vec3& unit) {
  const glm::vec3 axis = std::abs(unit.x) < 0.6F ? glm::vec3(1.0F, 0.0F, 0.0F) : glm::vec3(0.0F, 1.0F, 0.0F);
  return glm::normalize(axis - unit * glm::dot(axis, unit));
}

void repair_normals(TriangleMesh& mesh, MeshDiagnostics& diagnostics) {
  std::vector<glm::dvec3> geometric;  // computed at the first bad normal
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    const glm::dvec3 given(mesh.normals[i]);
    const double length = glm::length(given);
    if (std::isfinite(length) && length > static_cast<double>(min_normal_length)) {
      mesh.normals[i] = glm::vec3(given / length);
      continue;
    }
    ++diagnostics.bad_normals;
    if (geometric.empty()) {
      geometric = area_weighted_normals(mesh);
    }
    // Opposite triangles at one vertex cancel; any direction is equally wrong there.
    const double geometric_length = glm::length(geometric[i]);
    mesh.normals[i] =
        geometric_length > 0.0 ? glm::vec3(geometric[i] / geometric_length) : glm::vec3(0.0F, 0.0F, 1.0F);
  }
}

void repair_texcoords(TriangleMesh& mesh, MeshDiagnostics& diagnostics) {
  for (glm::vec2& uv : mesh.texcoords) {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) {
      uv = glm::vec2(0.0F);
      ++diagnostics.bad_texcoords;
    }
  }
}

/// One vertex per corner, each with the geometric normal of its triangle.
void make_flat(TriangleMesh& mesh) {
  keep_only(mesh.positions, mesh.indices);
  keep_only(mesh.texcoords, mesh.indices);
  mesh.normals.resize(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      mesh.indices[i + k] = static_cast<std::uint32_t>(i + k);
    }
    const glm::vec3 normal(glm::normalize(area_normal(mesh.positions, &mesh.indices[i])));
    std::fill_n(mesh.normals.begin() + static_cast<std::ptrdiff_t>(i), 3, normal);
  }
}

/// Twice the signed area of the triangle in texture space: its sign is the handedness.
double texture_cross(const TriangleMesh& mesh, const std::uint32_t* corner) {
  const glm::dvec2 a(mesh.texcoords[corner[0]]);
  const glm::dvec2 e1 = glm::dvec2(mesh.texcoords[corner[1]]) - a;
  const glm::dvec2 e2 = glm::dvec2(mesh.texcoords[corner[2]]) - a;
  return e1.x * e2.y - e2.x * e1.y;
}

/// Gives triangles with mirrored texture their own copies of vertices that they share with others.
/// @return +1 or -1 per vertex.
std::vector<float> split_by_handedness(TriangleMesh& mesh) {
  std::vector<float> handedness(mesh.positions.size(), 0.0F);
  std::vector<std::uint32_t> copy_of(mesh.positions.size(), 0);  // 0: none, as vertex 0 is never a copy
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const double cross = texture_cross(mesh, &mesh.indices[i]);
    if (cross == 0.0) {
      continue;
    }
    const float sign = cross > 0.0 ? 1.0F : -1.0F;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = mesh.indices[i + k];
      if (handedness[vertex] == 0.0F) {
        handedness[vertex] = sign;
      } else if (handedness[vertex] != sign) {
        if (copy_of[vertex] == 0) {
          copy_of[vertex] = static_cast<std::uint32_t>(mesh.positions.size());
          mesh.positions.push_back(mesh.positions[vertex]);
          mesh.normals.push_back(mesh.normals[vertex]);
          mesh.texcoords.push_back(mesh.texcoords[vertex]);
          handedness.push_back(sign);
        }
        mesh.indices[i + k] = copy_of[vertex];
      }
    }
  }
  return handedness;
}

}  // namespace

TriangleMesh validated_mesh(TriangleMesh mesh, MeshDiagnostics& diagnostics) {
  check_shape(mesh);
  drop_bad_triangles(mesh, diagnostics);
  drop_unused_vertices(mesh);
  repair_normals(mesh, diagnostics);
  repair_texcoords(mesh, diagnostics);
  return mesh;
}

void add_tangents(TriangleMesh& mesh) {
  if (mesh.normals.empty()) {
    make_flat(mesh);
  }
  const std::vector<float> handedness = split_by_handedness(mesh);
  std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0.0));
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const std::uint32_t* corner = &mesh.indices[i];
    const double cross = texture_cross(mesh, corner);
    if (cross == 0.0) {
      continue;
    }
    const glm::dvec3 a(mesh.positions[corner[0]]);
    const glm::dvec3 edge1 = glm::dvec3(mesh.positions[corner[1]]) - a;
    const glm::dvec3 edge2 = glm::dvec3(mesh.positions[corner[2]]) - a;
    const auto v0 = static_cast<double>(mesh.texcoords[corner[0]].y);
    const double dv1 = static_cast<double>(mesh.texcoords[corner[1]].y) - v0;
    const double dv2 = static_cast<double>(mesh.texcoords[corner[2]].y) - v0;
    const glm::dvec3 tangent = (edge1 * dv2 - edge2 * dv1) * (cross > 0.0 ? 1.0 : -1.0);
    const double length = glm::length(tangent);
    if (length > 0.0) {
      const double weight = glm::length(glm::cross(edge1, edge2)) / length;
      for (std::size_t k = 0; k < 3; ++k) {
        sums[corner[k]] += tangent * weight;
      }
    }
  }
  mesh.tangents.resize(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::dvec3 normal(mesh.normals[i]);
    const glm::dvec3 along = sums[i] - normal * glm::dot(normal, sums[i]);
    const double length = glm::length(along);
    // The component along the surface must exceed the rounding error of the sum.
    const bool clear = length > 1e-6 * glm::length(sums[i]) && length > 0.0;
    const glm::vec3 tangent = clear ? glm::vec3(along / length) : any_perpendicular(mesh.normals[i]);
    mesh.tangents[i] = glm::vec4(tangent, handedness[i] < 0.0F ? -1.0F : 1.0F);
  }
}

}  // namespace sonard::render
