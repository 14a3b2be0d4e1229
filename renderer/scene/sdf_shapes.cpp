// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/sdf_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "renderer/scene/primitives.hpp"

namespace sonard::render {

bool has_shape(const SdfElement& model, std::string_view kind) {
  return std::ranges::any_of(model.children, [&](const auto& child) {
    return (child->name == "link" && child->child(kind) != nullptr) ||
           (child->name == "model" && has_shape(*child, kind));
  });
}

glm::dvec3 vec3_of(const SdfElement& parent, std::string_view name, const glm::dvec3& otherwise) {
  const std::vector<double> n = numbers_of(parent.child(name), {otherwise.x, otherwise.y, otherwise.z});
  return {n[0], n[1], n[2]};
}

double number_of(const SdfElement& parent, std::string_view name, double otherwise) {
  return numbers_of(parent.child(name), {otherwise}).front();
}

std::string text_of(const SdfElement& parent, std::string_view name) {
  const SdfElement* const child = parent.child(name);
  return child == nullptr ? std::string() : child->text;
}

std::optional<TriangleMesh> primitive_of(const SdfElement& geometry) {
  if (geometry.name == "box") {
    return make_box(vec3_of(geometry, "size", {1, 1, 1}));
  }
  if (geometry.name == "sphere") {
    return make_sphere(number_of(geometry, "radius", 1));
  }
  if (geometry.name == "ellipsoid") {
    return make_ellipsoid(vec3_of(geometry, "radii", {1, 1, 1}));
  }
  if (geometry.name == "cylinder") {
    return make_cylinder(number_of(geometry, "radius", 1), number_of(geometry, "length", 1));
  }
  if (geometry.name == "cone") {
    return make_cone(number_of(geometry, "radius", 1), number_of(geometry, "length", 1));
  }
  if (geometry.name == "capsule") {
    return make_capsule(number_of(geometry, "radius", 0.5), number_of(geometry, "length", 1));
  }
  if (geometry.name == "plane") {
    const std::vector<double> size = numbers_of(geometry.child("size"), {1, 1});
    return make_plane({size[0], size[1]}, vec3_of(geometry, "normal", {0, 0, 1}));
  }
  return std::nullopt;
}

std::size_t primitive_triangles(const SdfElement& geometry) {
  const std::string& kind = geometry.name;
  if (kind == "box") {
    return 12;
  }
  if (kind == "plane") {
    return 2;
  }
  double radius_m = 0.0;
  try {
    if (kind == "ellipsoid") {
      const glm::dvec3 radii_m = vec3_of(geometry, "radii", {1, 1, 1});
      radius_m = std::max({radii_m.x, radii_m.y, radii_m.z});
    } else if (kind == "sphere" || kind == "cylinder" || kind == "cone" || kind == "capsule") {
      radius_m = number_of(geometry, "radius", kind == "capsule" ? 0.5 : 1);
    }
  } catch (const WorldError&) {
    return 0;
  }
  if (!std::isfinite(radius_m) || radius_m <= 0.0) {
    return 0;
  }
  const auto n = static_cast<std::size_t>(segments_around(radius_m));
  return kind == "cylinder" ? 4 * n : kind == "cone" ? 2 * n : kind == "capsule" ? n * n : n * (n - 2);
}

std::size_t primitive_triangles_below(const SdfElement& element, std::string_view kind) {
  std::size_t count = 0;
  for (const auto& child : element.children) {
    if (child->name == kind) {
      const SdfElement* const geometry = child->child("geometry");
      count += geometry == nullptr || geometry->children.empty()
                   ? 0
                   : primitive_triangles(*geometry->children.front());
    } else if (child->name == "link" || child->name == "model") {
      count += primitive_triangles_below(*child, kind);
    }
  }
  return count;
}

}  // namespace sonard::render
