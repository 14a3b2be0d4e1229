#include "renderer/visibility/slices/slice_facets.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "renderer/visibility/slices/slice_shading.hpp"

namespace sonard::render {

FacetSight::FacetSight(const PartSurface& part, const VisiblePiece& piece, const Slice& slice)
    : part_(part), piece_(piece), slice_(slice) {
  const float low = piece.low, high = piece.high, t = 0.5F * (low + high);
  const float secant = std::sqrt(1 + t * t);
  turn_ = {(high - low) / std::sqrt((1 + low * low) * (1 + high * high)), slice.width_rad / secant};
  const float cosine = std::abs(piece.normal_h + piece.normal_z * t) / secant;
  const float incidence = std::acos(std::min(cosine, 1.0F));
  const float nearer = 0.5F * (turn_.along + turn_.across) + part.bend_rad;
  may_hear_ = incidence - nearer < part.facet_reach_rad;
  if (may_hear_ && part.vertex_normals) {
    find_turn();
  }
}

/// Of a surface with normals of its own.
void FacetSight::find_turn() {
  const float t = 0.5F * (piece_.low + piece_.high), half = 0.5F * slice_.width_rad;
  turn_.along = glm::length(off_mirror(piece_.high, 0.0F) - off_mirror(piece_.low, 0.0F));
  turn_.across = glm::length(off_mirror(t, half) - off_mirror(t, -half));
}

FacetSight::Sight FacetSight::at(float t, float offset_rad) const {
  const float c = std::cos(offset_rad), s = std::sin(offset_rad);
  if (!part_.vertex_normals) {  // along the slice, across it, and up
    return {glm::normalize(glm::vec3(c, s, t)), {piece_.normal_h, piece_.normal_s, piece_.normal_z}};
  }
  const glm::vec3 q(slice_.cosine * c - slice_.sine * s, slice_.sine * c + slice_.cosine * s, t);
  return {part_.R_part_sonar * glm::normalize(q), interpolated_normal(part_, *piece_.triangle, q)};
}

/// 0 where a mirror would send sound back, and as long as the angle away from that, if small.
glm::vec3 FacetSight::off_mirror(float t, float offset_rad) const {
  const Sight sight = at(t, offset_rad);
  return sight.direction + (glm::dot(sight.normal, sight.direction) > 0 ? -sight.normal : sight.normal);
}

float FacetSight::response_at(float t, float offset_rad) const {
  const Sight sight = at(t, offset_rad);
  return part_.backscatter.facets(std::min(std::abs(glm::dot(sight.normal, sight.direction)), 1.0F));
}

float FacetSight::displacement_m() const {
  const float t = 0.5F * (piece_.low + piece_.high), secant = std::sqrt(1 + t * t);
  const float facing = piece_.normal_h + piece_.normal_z * t;
  const float range = secant / (piece_.w_at_0 + piece_.w_slope * t);
  const float by_azimuth = range * piece_.normal_s / facing;
  const FacetResponse facets = response(t);
  const float all = facets.mean + part_.backscatter.lambert(std::abs(facing) / secant);
  return all > 0 ? std::abs(by_azimuth * slice_.width_rad * facets.moment / all) : 0.0F;
}

FacetResponse FacetSight::response(float t) const {
  constexpr float narrow = 0.05F;  // of m: the middle is as good as the mean
  const float middle = response_at(t, 0.0F);
  if (turn_.across * turn_.across < narrow * narrow * part_.backscatter.slope_variance) {
    return {middle, 0.0F};
  }
  // Gauss and Legendre's three points.
  const float place = 0.5F * std::sqrt(0.6F);
  const float starboard = response_at(t, -place * slice_.width_rad);
  const float port = response_at(t, place * slice_.width_rad);
  return {(5 * (starboard + port) + 8 * middle) * (1.0F / 18), 5 * place * (port - starboard) * (1.0F / 18)};
}

}  // namespace sonard::render
