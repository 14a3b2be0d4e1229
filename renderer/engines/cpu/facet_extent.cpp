// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/facet_extent.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace sonard::render {

namespace {

using Polygon = std::vector<glm::dvec3>;

/// The part of a convex polygon with normal . p >= 0.
Polygon clipped(const Polygon& whole, const glm::dvec3& normal) {
  Polygon part;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const glm::dvec3& a = whole[i];
    const glm::dvec3& b = whole[(i + 1) % whole.size()];
    const double at_a = glm::dot(normal, a), at_b = glm::dot(normal, b);
    if (at_a >= 0) {
      part.push_back(a);
    }
    if ((at_a < 0) != (at_b < 0)) {
      part.push_back(a + (b - a) * (at_a / (at_a - at_b)));
    }
  }
  return part;
}

/// Distance of the origin from the edge from a to b.
double distance_of_edge(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double length2 = glm::dot(along, along);
  const double share = length2 > 0 ? std::clamp(-glm::dot(a, along) / length2, 0.0, 1.0) : 0.0;
  return glm::length(a + along * share);
}

/// Distance of the origin from a convex polygon.
double distance_of(const Polygon& polygon, const glm::dvec3& normal) {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = true;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3& a = polygon[i];
    const glm::dvec3& b = polygon[(i + 1) % polygon.size()];
    nearest = std::min(nearest, distance_of_edge(a, b));
    inside = inside && glm::dot(glm::cross(normal, b - a), -a) >= 0;  // the foot point is on the inner side
  }
  return inside ? std::abs(glm::dot(normal, polygon[0])) / glm::length(normal) : nearest;
}

}  // namespace

std::optional<FacetExtent> facet_extent(const FanTriangle& triangle, const Slice& slice) {
  const glm::dvec3 a(triangle.corner(0)), b(triangle.corner(1)), c(triangle.corner(2));
  const double half = 0.5 * static_cast<double>(slice.width_rad);
  const double starboard = slice.azimuth_rad - half, port = slice.azimuth_rad + half;
  Polygon part = clipped({a, b, c}, {-std::sin(starboard), std::cos(starboard), 0});
  part = clipped(part, {std::sin(port), -std::cos(port), 0});
  if (part.empty()) {
    return std::nullopt;
  }
  double furthest = 0;
  for (const glm::dvec3& corner : part) {
    furthest = std::max(furthest, glm::length(corner));
  }
  return FacetExtent{static_cast<float>(distance_of(part, glm::cross(b - a, c - a))),
                     static_cast<float>(furthest)};
}

void keep_within(const FacetExtent& extent, EchoPatch& patch) {
  const auto kept = [&](float range_m) { return std::clamp(range_m, extent.nearest_m, extent.furthest_m); };
  const float a_low = kept(patch.range_a_m - 0.5F * patch.smear_a_m);
  const float a_high = kept(patch.range_a_m + 0.5F * patch.smear_a_m);
  const float b_low = kept(patch.range_b_m - 0.5F * patch.smear_b_m);
  const float b_high = kept(patch.range_b_m + 0.5F * patch.smear_b_m);
  patch.range_a_m = 0.5F * (a_low + a_high);
  patch.smear_a_m = a_high - a_low;
  patch.range_b_m = 0.5F * (b_low + b_high);
  patch.smear_b_m = b_high - b_low;
  // Where ends cross, the echo is negative, and neighbours no longer make up for it.
  const bool cross = (a_low - b_low) * (a_high - b_high) <= 0;
  if (cross) {
    const float low = std::min(a_low, b_low), high = std::max(a_high, b_high);
    patch.range_a_m = patch.range_b_m = 0.5F * (low + high);
    patch.smear_a_m = patch.smear_b_m = high - low;
  }
  if (cross || patch.smear_a_m + patch.smear_b_m >= std::abs(patch.range_b_m - patch.range_a_m)) {
    patch.echo_gradient = patch.weight_gradient = 0.0F;  // only for ends that are far apart
  }
}

}  // namespace sonard::render
