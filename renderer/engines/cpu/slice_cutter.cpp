// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/slice_cutter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

using slices::least_missed;
using slices::nearest_m;
using slices::shortest_rad;

constexpr std::size_t widest_vector = 16;  // arrays have a multiple of this length: loops have no remainder
constexpr float sharp_turn_rad = 0.6F;
constexpr double same_edge_rad = 2e-6;  // nearer edges count as one

/// Azimuth of a triangle's normal, turned away from the sonar.
float facing(const FanTriangle& t) {
  const glm::vec3 n = t.across();
  return glm::dot(n, t.corner(0)) < 0 ? std::atan2(-n.y, -n.x) : std::atan2(n.y, n.x);
}

/// Tangent of the elevation of a corner.
float elevation_of(const FanTriangle& t, std::size_t corner) {
  return t.z[corner] / std::sqrt(t.x[corner] * t.x[corner] + t.y[corner] * t.y[corner] + 1e-30F);
}

/// True if an azimuth lies inside the wedge of a slice, and not at its border.
bool lies_well_inside(double azimuth_rad, const Slice& slice) {
  constexpr double margin = 1e-3;  // of the wedge
  return std::abs(azimuth_rad - slice.azimuth_rad) < (0.5 - margin) * static_cast<double>(slice.width_rad);
}

}  // namespace

void SliceCutter::load(std::span<const ListedTriangle> triangles, double low_rad, double high_rad,
                       const Fan& fan, bool two_sided) {
  const auto low = static_cast<float>(low_rad) - azimuth_error_rad;
  const auto high = static_cast<float>(high_rad) + azimuth_error_rad;
  triangles_.clear();
  for (const ListedTriangle& t : triangles) {
    if (t.high_azimuth_rad >= low && t.low_azimuth_rad <= high) {
      __builtin_prefetch(t.triangle);  // they lie far apart
      triangles_.push_back(t.triangle);
    }
  }
  list_upright_edges(low_rad, high_rad, fan);
  if (!two_sided) {
    drop_back_faces();
  }
  padded_ = (triangles_.size() + widest_vector - 1) / widest_vector * widest_vector;
  for (auto* corner : {x_, y_, z_}) {
    for (int k = 0; k < 3; ++k) {
      corner[k].resize(padded_);
    }
  }
  part_.resize(padded_);
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    part_[i] = triangles_[i]->part;
    for (int k = 0; k < 3; ++k) {
      x_[k][i] = triangles_[i]->x[k];
      y_[k][i] = triangles_[i]->y[k];
      z_[k][i] = triangles_[i]->z[k];
    }
  }
  for (std::size_t i = triangles_.size(); i < padded_; ++i) {
    for (int k = 0; k < 3; ++k) {
      x_[k][i] = y_[k][i] = z_[k][i] = 0.0F;  // cut by no slice
    }
  }
  for (auto* array : {&normal_x_, &normal_y_, &normal_z_}) {
    array->resize(padded_);
  }
  fate_.resize(padded_);
  load_normals();
  list_thin();
}

SONARD_SIMD_CLONES
void SliceCutter::load_normals() {
  const float* __restrict x0 = x_[0].data();
  const float* __restrict x1 = x_[1].data();
  const float* __restrict x2 = x_[2].data();
  const float* __restrict y0 = y_[0].data();
  const float* __restrict y1 = y_[1].data();
  const float* __restrict y2 = y_[2].data();
  const float* __restrict z0 = z_[0].data();
  const float* __restrict z1 = z_[1].data();
  const float* __restrict z2 = z_[2].data();
  float* __restrict nx = normal_x_.data();
  float* __restrict ny = normal_y_.data();
  float* __restrict nz = normal_z_.data();
  const std::size_t count = padded_;
  for (std::size_t i = 0; i < count; ++i) {
    const float ax = x1[i] - x0[i], ay = y1[i] - y0[i], az = z1[i] - z0[i];
    const float bx = x2[i] - x0[i], by = y2[i] - y0[i], bz = z2[i] - z0[i];
    const float cx = ay * bz - az * by, cy = az * bx - ax * bz, cz = ax * by - ay * bx;
    const float scale = 1.0F / std::sqrt(cx * cx + cy * cy + cz * cz + 1e-36F);
    nx[i] = cx * scale;
    ny[i] = cy * scale;
    nz[i] = cz * scale;
  }
}

void SliceCutter::drop_back_faces() {
  const auto seen_from_behind = [](const FanTriangle* t) { return glm::dot(t->across(), t->corner(0)) > 0; };
  std::erase_if(triangles_, seen_from_behind);
}

/// Joins triangles of one kind and part that touch in azimuth to one thing, so that a slice hits or misses a
/// whole pole instead of single facets.
void SliceCutter::list_thin() {
  thin_.clear();
  low_ends_.clear();
  for (const FanTriangle* t : triangles_) {
    const auto add = [&](Kind kind) {
      const auto [low_t, high_t] =
          std::minmax({elevation_of(*t, 0), elevation_of(*t, 1), elevation_of(*t, 2)});
      thin_.push_back({kind, t->part, t->low_azimuth_rad, t->high_azimuth_rad, low_t, high_t});
    };
    if (t->thin || t->small) {
      add(t->thin ? Kind::thin : Kind::small);
    }
    if (t->low) {
      add(Kind::low);
    }
  }
  std::sort(thin_.begin(), thin_.end(), [](const ThinThing& a, const ThinThing& b) {
    return std::tie(a.kind, a.part, a.low_azimuth_rad) < std::tie(b.kind, b.part, b.low_azimuth_rad);
  });
  thin_triangles_ = thin_;
  std::size_t things = 0;
  for (const ThinThing& thing : thin_) {
    if (things > 0 && thin_[things - 1].kind == thing.kind && thin_[things - 1].part == thing.part &&
        thing.low_azimuth_rad <= thin_[things - 1].high_azimuth_rad) {
      thin_[things - 1].high_azimuth_rad =
          std::max(thin_[things - 1].high_azimuth_rad, thing.high_azimuth_rad);
    } else {
      thin_[things++] = thing;
    }
  }
  thin_.resize(things);
  for (; !thin_.empty() && thin_.back().kind == Kind::low; thin_.pop_back()) {
    low_ends_.insert(low_ends_.end(), {thin_.back().low_azimuth_rad, thin_.back().high_azimuth_rad});
  }
}

void SliceCutter::list_upright_edges(double low_rad, double high_rad, const Fan& fan) {
  edge_parts_.clear();
  for (const FanTriangle* t : triangles_) {
    if (t->upright) {
      add_edge_parts(*t, low_rad, high_rad, fan);
    }
  }
  std::sort(edge_parts_.begin(), edge_parts_.end(),
            [](const EdgePart& a, const EdgePart& b) { return a.azimuth_rad < b.azimuth_rad; });
}

/// Compares azimuths by the tangent of their difference, which is cheap; most edges are not upright.
void SliceCutter::add_edge_parts(const FanTriangle& triangle, double low_rad, double high_rad,
                                 const Fan& fan) {
  double x[3], y[3], t[3];
  for (int k = 0; k < 3; ++k) {
    x[k] = static_cast<double>(triangle.x[k]);
    y[k] = static_cast<double>(triangle.y[k]);
    t[k] = static_cast<double>(triangle.z[k]) / std::sqrt(x[k] * x[k] + y[k] * y[k]);
  }
  const auto tan_limit = static_cast<double>(fan.tan_limit());
  const auto probe = [tan_limit](double at) {
    const double place =
        (at / (static_cast<double>(slices::probe_reach) * tan_limit) + 1) * (0.5 * (side_probes - 1)) + 1;
    return static_cast<std::int32_t>(std::clamp(place, 0.0, static_cast<double>(side_probes)));
  };
  const auto turn = [&](int from, int to) {
    return (x[from] * y[to] - y[from] * x[to]) / (x[from] * x[to] + y[from] * y[to]);
  };
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3, opposite = (k + 2) % 3;
    const double lean = turn(k, next);
    if (!(std::abs(lean) < static_cast<double>(fan.upright_rad()))) {  // not a number: above or at the sonar
      continue;
    }
    const std::int32_t first = probe(std::min(t[k], t[next])), last = probe(std::max(t[k], t[next]));
    if (last - first < 2) {
      continue;
    }
    const double at = std::atan2(y[k], x[k]) + 0.5 * lean;
    if (at > low_rad && at < high_rad) {
      // The point of the edge, or of its continuation, at the height of the third corner.
      const double beside = lean * (t[opposite] - t[k]) / (t[next] - t[k]);
      edge_parts_.push_back({at, first, last, turn(k, opposite) > beside ? 1 : -1, facing(triangle)});
    }
  }
}

/// Probes of the edge parts [begin, end), which are at one azimuth.
ProbeSet SliceCutter::probes_of_edge(std::size_t begin, std::size_t end) const {
  std::array<std::int32_t, side_probes + 1> sides{};
  std::array<float, side_probes + 1> turns{};
  for (std::size_t i = begin; i < end; ++i) {
    const EdgePart& part = edge_parts_[i];
    const auto first = static_cast<std::size_t>(part.first_probe);
    const auto last = static_cast<std::size_t>(part.last_probe);
    sides[first] += part.side;
    sides[last] -= part.side;
    turns[first] += static_cast<float>(part.side) * part.facing_rad;
    turns[last] -= static_cast<float>(part.side) * part.facing_rad;
  }
  ProbeSet probes;
  std::int32_t side = 0;
  float turn = 0.0F;
  for (std::size_t k = 0; k < side_probes; ++k) {
    side += sides[k];
    turn += turns[k];
    // Modulo a turn: of two normals that point backwards, one may have azimuth pi and the other -pi.
    probes[k] = side != 0 || std::abs(std::remainder(turn, 2 * slices::half_turn)) > sharp_turn_rad;
  }
  return probes;
}

void SliceCutter::find_upright_edges(const Slice& slice, std::vector<UprightEdge>& edges) const {
  constexpr std::size_t most_edges = 4;
  constexpr std::int32_t least_probes = 12;  // for lower edges even parts are as good
  edges.clear();
  for (const float at : low_ends_) {
    if (lies_well_inside(static_cast<double>(at), slice)) {
      edges.push_back({static_cast<double>(at), {}});
    }
  }
  std::size_t begin = 0;
  for (std::size_t i = 0; i < edge_parts_.size(); ++i) {
    const double at = edge_parts_[begin].azimuth_rad;
    if (i + 1 < edge_parts_.size() && edge_parts_[i + 1].azimuth_rad - at < same_edge_rad) {
      continue;
    }
    std::int32_t most_probes = 0;
    for (std::size_t k = begin; k <= i; ++k) {
      most_probes += edge_parts_[k].last_probe - edge_parts_[k].first_probe;
    }
    if (most_probes >= least_probes && lies_well_inside(at, slice)) {
      const ProbeSet probes = probes_of_edge(begin, i + 1);
      if (probes.count() >= static_cast<std::size_t>(least_probes)) {
        edges.push_back({at, probes});
      }
    }
    begin = i + 1;
  }
  if (edges.size() > most_edges) {
    std::nth_element(
        edges.begin(), edges.begin() + most_edges, edges.end(),
        [](const UprightEdge& a, const UprightEdge& b) { return a.probes.count() > b.probes.count(); });
    edges.resize(most_edges);
  }
  std::sort(edges.begin(), edges.end(),
            [](const UprightEdge& a, const UprightEdge& b) { return a.azimuth_rad > b.azimuth_rad; });
}

float SliceCutter::missed_height(const Slice& slice) const {
  const auto azimuth = static_cast<float>(slice.azimuth_rad);
  const float half = 0.5F * slice.width_rad;
  float height = 0.0F;
  for (const ThinThing& thing : thin_) {
    const float port = thing.high_azimuth_rad - azimuth;
    const float starboard = thing.low_azimuth_rad - azimuth;
    // A neighbouring slice may hit it, but a thing that reaches into this wedge must be hit here. The margin
    // is the error of azimuths: a slice along the very edge of a thing may miss it too.
    if ((starboard > -azimuth_error_rad && starboard < half) || (port < azimuth_error_rad && port > -half)) {
      height = std::max({height, height_within(slice, thing), least_missed});
    }
  }
  const bool low_thing_ends = std::any_of(low_ends_.begin(), low_ends_.end(), [&](float at) {
    return lies_well_inside(static_cast<double>(at), slice);
  });
  return low_thing_ends ? std::max(height, least_missed) : height;
}

/// Height in t of the triangles of a thing that reach into the wedge of a slice. It does not depend on what
/// else is loaded.
float SliceCutter::height_within(const Slice& slice, const ThinThing& thing) const {
  const auto azimuth = static_cast<float>(slice.azimuth_rad);
  const float half = 0.5F * slice.width_rad;
  float low = 0.0F, high = 0.0F;
  bool any = false;
  for (const ThinThing& t : thin_triangles_) {
    if (t.kind == thing.kind && t.part == thing.part && t.low_azimuth_rad < azimuth + half &&
        t.high_azimuth_rad > azimuth - half) {
      low = any ? std::min(low, t.low_t) : t.low_t;
      high = any ? std::max(high, t.high_t) : t.high_t;
      any = true;
    }
  }
  return high - low;
}

void SliceCutter::cut(const Slice& slice, float tan_limit, Segments& segments) {
  for (auto* array : {&segments.low, &segments.high, &segments.w_at_0, &segments.w_slope, &segments.low_slope,
                      &segments.high_slope, &segments.low_reach, &segments.high_reach}) {
    array->resize(padded_);
  }
  segments.kept.resize(padded_ + 1);
  cut_all(slice, tan_limit, segments);
  std::size_t count = 0;
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    if (fate_[i] == slices::cut_is_partly_behind) {
      clip_behind(slice, tan_limit, i, segments);
    }
    segments.kept[count] = static_cast<std::int32_t>(i);
    count += fate_[i] == slices::cut_keeps ? 1 : 0;
  }
  segments.kept.resize(count);
}

SONARD_SIMD_CLONES
void SliceCutter::cut_all(const Slice& slice, float tan_limit, Segments& segments) {
  const float cosine = slice.cosine, sine = slice.sine;
  const float* __restrict x0 = x_[0].data();
  const float* __restrict x1 = x_[1].data();
  const float* __restrict x2 = x_[2].data();
  const float* __restrict y0 = y_[0].data();
  const float* __restrict y1 = y_[1].data();
  const float* __restrict y2 = y_[2].data();
  const float* __restrict z0 = z_[0].data();
  const float* __restrict z1 = z_[1].data();
  const float* __restrict z2 = z_[2].data();
  float* __restrict low = segments.low.data();
  float* __restrict high = segments.high.data();
  float* __restrict at_0 = segments.w_at_0.data();
  float* __restrict slope = segments.w_slope.data();
  float* __restrict low_slope = segments.low_slope.data();
  float* __restrict high_slope = segments.high_slope.data();
  float* __restrict low_reach = segments.low_reach.data();
  float* __restrict high_reach = segments.high_reach.data();
  std::int32_t* __restrict fate = fate_.data();
  const std::size_t count = padded_;
  for (std::size_t i = 0; i < count; ++i) {
    const slices::CutTriangle cut = slices::cut_triangle({x0[i], y0[i], z0[i]}, {x1[i], y1[i], z1[i]},
                                                         {x2[i], y2[i], z2[i]}, cosine, sine, tan_limit);
    low[i] = cut.low;
    high[i] = cut.high;
    at_0[i] = cut.w_at_0;
    slope[i] = cut.w_slope;
    low_slope[i] = cut.low_slope;
    high_slope[i] = cut.high_slope;
    low_reach[i] = cut.low_reach;
    high_reach[i] = cut.high_reach;
    fate[i] = cut.fate;
  }
}

/// Cuts a triangle that crosses the plane of the slice behind the vertical axis too; in doubles and one at a
/// time, because such triangles are rare.
void SliceCutter::clip_behind(const Slice& slice, float tan_limit, std::size_t i, Segments& segments) {
  const auto cosine = static_cast<double>(slice.cosine), sine = static_cast<double>(slice.sine);
  double s[3], h[3], z[3];
  for (int k = 0; k < 3; ++k) {
    const auto x = static_cast<double>(x_[k][i]), y = static_cast<double>(y_[k][i]);
    s[k] = y * cosine - x * sine;
    h[k] = x * cosine + y * sine;
    z[k] = static_cast<double>(z_[k][i]);
  }
  double end_h[2] = {0, 0}, end_z[2] = {0, 0};
  int ends = 0;
  for (int k = 0; k < 3 && ends < 2; ++k) {
    const int j = (k + 1) % 3;
    if ((s[k] >= 0) != (s[j] >= 0)) {
      const double share = s[k] / (s[k] - s[j]);
      end_h[ends] = h[k] + (h[j] - h[k]) * share;
      end_z[ends++] = z[k] + (z[j] - z[k]) * share;
    }
  }
  fate_[i] = slices::cut_misses;
  if (ends < 2 || std::max(end_h[0], end_h[1]) <= static_cast<double>(nearest_m)) {
    return;
  }
  const int back = end_h[0] < end_h[1] ? 0 : 1;
  if (end_h[back] < static_cast<double>(nearest_m)) {
    const double share = (static_cast<double>(nearest_m) - end_h[back]) / (end_h[1 - back] - end_h[back]);
    end_z[back] += (end_z[1 - back] - end_z[back]) * share;
    end_h[back] = static_cast<double>(nearest_m);
  }
  const double t0 = end_z[0] / end_h[0], t1 = end_z[1] / end_h[1];
  const int lower = t0 < t1 ? 0 : 1;
  const double a = std::min(t0, t1), b = std::max(t0, t1);
  if (!(b - a > static_cast<double>(shortest_rad) * (1 + a * a)) || b < -static_cast<double>(tan_limit) ||
      a > static_cast<double>(tan_limit)) {
    return;
  }
  const double steepness = (1 / end_h[1 - lower] - 1 / end_h[lower]) / (b - a);
  segments.low[i] = static_cast<float>(a);
  segments.high[i] = static_cast<float>(b);
  segments.w_slope[i] = static_cast<float>(steepness);
  segments.w_at_0[i] = static_cast<float>(1 / end_h[lower] - steepness * a);
  segments.low_slope[i] = segments.high_slope[i] = 0.0F;
  segments.low_reach[i] = segments.high_reach[i] = 0.0F;
  fate_[i] = slices::cut_keeps;
}

}  // namespace sonard::render
