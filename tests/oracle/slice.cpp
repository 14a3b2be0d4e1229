// SPDX-License-Identifier: Apache-2.0
#include "tests/oracle/slice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

namespace sonard::oracle {

namespace {

/// A point of the half-plane: distance from the sonar's z axis, and height.
struct SlicePoint {
  double rho, z;
};

constexpr double touching_m = 1e-9;  // surfaces nearer to the z axis are cut off

/// Cuts off the part with negative `inside`, an affine function of the point. @return false if nothing is
/// left
template <class Inside>
bool clip(SlicePoint& p, SlicePoint& q, Inside inside) {
  const double at_p = inside(p);
  const double at_q = inside(q);
  if (at_p < 0 && at_q < 0) {
    return false;
  }
  if (at_p < 0 || at_q < 0) {
    const double share = at_p / (at_p - at_q);
    (at_p < 0 ? p : q) = {p.rho + share * (q.rho - p.rho), p.z + share * (q.z - p.z)};
  }
  return true;
}

/// Clips to the fan. Done before tangents are computed, because outside the fan they grow without bound.
bool clip_to_fan(SlicePoint& p, SlicePoint& q, double tan_limit) {
  return clip(p, q, [&](const SlicePoint& x) { return x.rho - touching_m; }) &&
         clip(p, q, [&](const SlicePoint& x) { return tan_limit * x.rho - x.z; }) &&
         clip(p, q, [&](const SlicePoint& x) { return tan_limit * x.rho + x.z; });
}

// Gauss-Legendre with three nodes on [-1, 1].
constexpr std::array<double, 3> node = {-0.774596669241483377, 0.0, 0.774596669241483377};
constexpr std::array<double, 3> node_weight = {5.0 / 9, 8.0 / 9, 5.0 / 9};
constexpr double panel_angle = 0.03;    // the three nodes err by 1e-10 for r^-6, the steepest law
constexpr int panels_per_facet = 8;     // for a facet with interpolated normals
constexpr double most_panels = 1e5;     // limit for textures with extremely fine detail
constexpr double panels_per_texel = 2;  // a bilinear texture has a kink at each texel

}  // namespace

/// The line of a visible cut in the half-plane: foot point at distance D from the sonar, and s along the
/// line.
struct Slicer::Cut {
  const Facet* facet;
  double distance_m;       // D
  SlicePoint foot, along;  // foot point; unit vector along the line
  double panel_m;          // longest panel for the shading
  double azimuth_cos, azimuth_sin;

  SlicePoint at(double s) const { return {foot.rho + s * along.rho, foot.z + s * along.z}; }
};

Slicer::Slicer(const Facets& facets, const EchoLaw& law)
    : facets_(facets), law_(law), tan_limit_(std::tan(law.elevation_limit_rad())) {}

void Slicer::add(double psi_rad, std::span<const std::uint32_t> candidates, LineSums& sums) {
  cos_psi_ = std::cos(psi_rad);
  sin_psi_ = std::sin(psi_rad);
  sightlines_.clear();
  for (const std::uint32_t index : candidates) {
    cut(index);
  }
  for (const VisiblePiece& piece : envelope_.visible(sightlines_)) {
    add_piece(piece, sums);
  }
}

/// Adds the segment of the facet in the half-plane, if they intersect.
void Slicer::cut(std::uint32_t index) {
  const Facet& facet = facets_.all()[index];
  std::array<double, 3> side{};
  for (std::size_t i = 0; i < 3; ++i) {
    side[i] = facet.corners[i].y * cos_psi_ - facet.corners[i].x * sin_psi_;
  }
  std::array<SlicePoint, 2> ends{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if ((side[i] < 0) == (side[j] < 0)) {
      continue;
    }
    // Always from the negative to the positive corner, so that both triangles at this edge compute the same
    // bits.
    const std::size_t from = side[i] < 0 ? i : j;
    const std::size_t to = side[i] < 0 ? j : i;
    const double share = side[from] / (side[from] - side[to]);
    const glm::dvec3 p = facet.corners[from] + share * (facet.corners[to] - facet.corners[from]);
    ends.at(count++) = {p.x * cos_psi_ + p.y * sin_psi_, p.z};
  }
  if (count != 2 || !clip_to_fan(ends[0], ends[1], tan_limit_)) {
    return;
  }
  Sightline line{ends[0].z / ends[0].rho, ends[1].z / ends[1].rho, 1 / ends[0].rho, 0, index};
  double w_end = 1 / ends[1].rho;
  if (line.t_begin > line.t_end) {
    std::swap(line.t_begin, line.t_end);
    std::swap(line.w_begin, w_end);
  }
  if (!(line.t_end > line.t_begin)) {
    return;  // edge-on
  }
  line.w_slope = (w_end - line.w_begin) / (line.t_end - line.t_begin);
  sightlines_.push_back(line);
}

void Slicer::add_piece(const VisiblePiece& piece, LineSums& sums) const {
  const Sightline& line = sightlines_[piece.sightline];
  const double w_begin = line.closeness(piece.t_begin);
  const double w_end = line.closeness(piece.t_end);
  if (!(w_begin > 0) || !(w_end > 0)) {
    return;
  }
  // In (t, w) the cut is w = w_begin + w_slope (t - t_begin). With t = z / rho and w = 1 / rho, this is the
  // line (w_begin - w_slope t_begin) rho + w_slope z = 1.
  const double normal_rho = line.w_begin - line.w_slope * line.t_begin;
  const double length = std::hypot(normal_rho, line.w_slope);
  if (!(length > 0)) {
    return;
  }
  Cut cut{};
  cut.facet = &facets_.all()[line.facet];
  cut.distance_m = 1 / length;
  cut.foot = {normal_rho / length * cut.distance_m, line.w_slope / length * cut.distance_m};
  cut.along = {-line.w_slope / length, normal_rho / length};  // t increases with s
  cut.azimuth_cos = cos_psi_;
  cut.azimuth_sin = sin_psi_;
  const auto position = [&](double t, double w) { return (1 / w) * cut.along.rho + (t / w) * cut.along.z; };
  const double s_begin = position(piece.t_begin, w_begin);
  const double s_end = position(piece.t_end, w_end);
  cut.panel_m = facets_.is_shaded(*cut.facet) ? std::min((s_end - s_begin) / panels_per_facet,
                                                         facets_.detail_m(*cut.facet) / panels_per_texel)
                                              : s_end - s_begin;
  if (s_begin < 0) {
    add_branch(cut, -1.0, std::max(0.0, -s_end), -s_begin, sums);
  }
  if (s_end > 0) {
    add_branch(cut, 1.0, std::max(0.0, s_begin), s_end, sums);
  }
}

/// Adds the part with |s| in [from, to) on one side of the foot point, where the range increases with |s|.
void Slicer::add_branch(const Cut& cut, double side, double from, double to, LineSums& sums) const {
  const double step = law_.step_m();
  const double d = cut.distance_m;
  double line = std::floor(std::hypot(d, from) / step);
  while (from < to && line < law_.lines()) {
    const double edge_range = (line + 1) * step;
    const double edge = std::sqrt(std::max(0.0, (edge_range - d) * (edge_range + d)));
    const double end = std::min(to, edge);
    if (end > from) {
      add_panel(cut, side * from, side * end, static_cast<std::size_t>(line), sums);
      from = end;
    }
    line += 1;
  }
}

/// Adds the part between s = from and s = to, which lies in one range line.
/// dOmega = cos(theta) dtheta dpsi, and along the cut dtheta = D ds / r^2.
void Slicer::add_panel(const Cut& cut, double from, double to, std::size_t line, LineSums& sums) const {
  const double length = std::abs(to - from);
  const double d = cut.distance_m;
  const double angle = length / std::hypot(d, std::min(std::abs(from), std::abs(to)));
  const double wanted = std::ceil(std::max(angle / panel_angle, length / cut.panel_m - 1e-9));
  const int panels = static_cast<int>(std::clamp(wanted, 1.0, most_panels));
  const double half = (to - from) / (2 * panels);
  const Material& material = facets_.material(*cut.facet);
  for (int panel = 0; panel < panels; ++panel) {
    const double centre = from + (2 * panel + 1) * half;
    for (std::size_t i = 0; i < node.size(); ++i) {
      const SlicePoint p = cut.at(centre + node[i] * half);
      const double range_squared = p.rho * p.rho + p.z * p.z;
      const double range = std::sqrt(range_squared);
      const glm::dvec3 point(p.rho * cut.azimuth_cos, p.rho * cut.azimuth_sin, p.z);
      const double cosine = glm::dot(facets_.shading_normal(*cut.facet, point), point) / range;
      const double solid_angle = node_weight[i] * std::abs(half) * d * p.rho / (range_squared * range);
      const double sin_elevation = p.z / range;
      sums.echo[line] += solid_angle * law_.echo(material, cosine, range, sin_elevation);
      if (!sums.weight.empty()) {
        sums.weight[line] += solid_angle * law_.pattern(sin_elevation);
      }
    }
  }
}

}  // namespace sonard::oracle
