#include "renderer/visibility/slices/slice_patches.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "renderer/simd.hpp"
#include "renderer/visibility/slices/slice_shading.hpp"

namespace sonard::render {

namespace {

constexpr int pattern_steps = 1024;
constexpr int most_divisions = 16;  // of a piece at once
constexpr int most_rounds = 6;      // near a foot point the divided pieces are divided again
// Under a normal map pieces are no longer than this many lines, so that its bumps appear at their ranges.
constexpr float mapped_lines = 2.0F;

}  // namespace

ElevationPattern::ElevationPattern(const Aperture& aperture, bool tabled_if_flat)
    : tan_limit_(static_cast<float>(std::tan(aperture.elevation_limit_rad()))) {
  if (aperture.elevation == Aperture::Elevation::top_hat && !tabled_if_flat) {
    return;
  }
  for (int i = 0; i <= pattern_steps; ++i) {
    const double t = static_cast<double>(tan_limit_) * (2.0 * i / pattern_steps - 1);
    weight_.push_back(static_cast<float>(aperture.elevation_weight(std::atan(t))));
  }
}

float ElevationPattern::at(float t) const {
  if (weight_.empty()) {
    return 1.0F;
  }
  const float place = std::clamp((t / tan_limit_ + 1) * (0.5F * pattern_steps), 0.0F, pattern_steps - 1e-3F);
  const auto step = static_cast<std::size_t>(place);
  const float rest = place - static_cast<float>(step);
  return weight_[step] * (1 - rest) + weight_[step + 1] * rest;
}

void SlicePatcher::make(const Request& request, std::vector<EchoPatch>& patches) {
  pieces_ = request.pieces;
  follow_crossings(request);
  lay_out(request);
  measure(request);
  for (int round = 0; round < most_rounds && divide_uneven(request); ++round) {
    lay_out(request);
    measure(request);
  }
  shade(request);
  const std::size_t begin = patches.size();
  patches.resize(begin + pieces_.size());
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    patches[begin + i] = {
        range_low_[i],  range_high_[i], smear_low_[i], smear_high_[i], response_[i] * solid_angle_[i],
        solid_angle_[i]};
  }
}

/// Where two surfaces cross, their pieces end along the line in which their planes meet. Its direction e
/// gives dt / d azimuth = (e_z - t e_h) / e_s, as for the edge of a triangle.
void SlicePatcher::follow_crossings(const Request& request) {
  const float cosine = request.slice.cosine, sine = request.slice.sine;
  const auto normal = [&](const VisiblePiece& piece) {
    const auto t = static_cast<std::size_t>(piece.segment);
    return glm::vec3(request.cutter.normal_x()[t], request.cutter.normal_y()[t],
                     request.cutter.normal_z()[t]);
  };
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    if (!std::isnan(pieces_[i].high_drift)) {
      continue;
    }
    float drift = 0.0F;
    if (i + 1 < pieces_.size()) {
      const glm::vec3 e = glm::cross(normal(pieces_[i]), normal(pieces_[i + 1]));
      const float along = e.x * cosine + e.y * sine;
      const float across = e.y * cosine - e.x * sine;
      // Over the wedge it moves no farther than the longer piece reaches.
      const float reach =
          std::max(pieces_[i].high - pieces_[i].low, pieces_[i + 1].high - pieces_[i + 1].low) /
          request.slice.width_rad;
      drift = (e.z - pieces_[i].high * along) / across;
      drift = std::isfinite(drift) ? std::clamp(drift, -reach, reach) : 0.0F;
      pieces_[i + 1].low_drift = drift;
    }
    pieces_[i].high_drift = drift;
  }
}

/// Gathers what the pieces' segments and triangles say of them.
void SlicePatcher::lay_out(const Request& request) {
  const std::size_t count = pieces_.size();
  for (auto* array : {&low_, &high_, &low_drift_, &high_drift_, &w_at_0_, &w_slope_, &w_by_azimuth_,
                      &normal_h_, &normal_s_, &normal_z_, &range_low_, &range_mid_, &range_high_, &smear_low_,
                      &smear_high_, &cosine_, &solid_angle_, &response_}) {
    array->resize(count);
  }
  first_probe_.resize(count);
  last_probe_.resize(count);
  const float cosine = request.slice.cosine, sine = request.slice.sine;
  const float* nx = request.cutter.normal_x();
  const float* ny = request.cutter.normal_y();
  const float* nz = request.cutter.normal_z();
  for (std::size_t i = 0; i < count; ++i) {
    const auto segment = static_cast<std::size_t>(pieces_[i].segment);
    low_[i] = pieces_[i].low;
    high_[i] = pieces_[i].high;
    low_drift_[i] = pieces_[i].low_drift;
    high_drift_[i] = pieces_[i].high_drift;
    w_at_0_[i] = request.segments.w_at_0[segment];
    w_slope_[i] = request.segments.w_slope[segment];
    normal_h_[i] = nx[segment] * cosine + ny[segment] * sine;
    normal_s_[i] = ny[segment] * cosine - nx[segment] * sine;
    normal_z_[i] = nz[segment];
  }
}

/// Ranges at both ends and in the middle, the smear of the ends, incidence and solid angle. On the plane n.p
/// = D the ray (1, 0, t) has 1 / h = (n_h + n_z t) / D, and its range is sqrt(1 + t^2) h. An end that drifts
/// by m = dt / d azimuth changes range by dr/d azimuth + m dr/dt (docs/physics.md 2.3, equation 2, along the
/// edge).
SONARD_SIMD_CLONES
void SlicePatcher::measure(const Request& request) {
  const float width = request.slice.width_rad;
  const auto count = pieces_.size();
  const float* __restrict low = low_.data();
  const float* __restrict high = high_.data();
  const float* __restrict low_drift = low_drift_.data();
  const float* __restrict high_drift = high_drift_.data();
  const float* __restrict w_at_0 = w_at_0_.data();
  const float* __restrict w_slope = w_slope_.data();
  const float* __restrict normal_h = normal_h_.data();
  const float* __restrict normal_s = normal_s_.data();
  const float* __restrict normal_z = normal_z_.data();
  float* __restrict range_low = range_low_.data();
  float* __restrict range_high = range_high_.data();
  float* __restrict smear_low = smear_low_.data();
  float* __restrict smear_high = smear_high_.data();
  float* __restrict range_mid = range_mid_.data();
  float* __restrict cos_phi = cosine_.data();
  float* __restrict solid_angle = solid_angle_.data();
  float* __restrict w_by_azimuth = w_by_azimuth_.data();
  for (std::size_t i = 0; i < count; ++i) {
    const float t1 = low[i], t2 = high[i], tm = 0.5F * (t1 + t2);
    const float b = w_slope[i];
    const float w1 = w_at_0[i] + b * t1, w2 = w_at_0[i] + b * t2, wm = w_at_0[i] + b * tm;
    const float q1 = 1 + t1 * t1, q2 = 1 + t2 * t2, qm = 1 + tm * tm;
    const float g1 = std::sqrt(q1), g2 = std::sqrt(q2), gm = std::sqrt(qm);
    const float r1 = g1 / w1, r2 = g2 / w2;
    const float n1 = normal_h[i] + normal_z[i] * t1, n2 = normal_h[i] + normal_z[i] * t2;
    const float by_azimuth1 = -r1 * normal_s[i] / n1, by_azimuth2 = -r2 * normal_s[i] / n2;
    const float by_t1 = r1 * (t1 / q1 - b / w1), by_t2 = r2 * (t2 / q2 - b / w2);
    range_low[i] = r1;
    range_mid[i] = gm / wm;
    range_high[i] = r2;
    smear_low[i] = std::abs(by_azimuth1 + by_t1 * low_drift[i]) * width;
    smear_high[i] = std::abs(by_azimuth2 + by_t2 * high_drift[i]) * width;
    const float nm = normal_h[i] + normal_z[i] * tm;
    // On a plane 1 / h changes with azimuth by n_s / D, wherever on it.
    w_by_azimuth[i] = wm * normal_s[i] / nm;
    const float cosine = std::abs(nm) / gm;
    cos_phi[i] = cosine < 1 ? cosine : 1.0F;
    solid_angle[i] = (t2 / g2 - t1 / g1) * width;
  }
}

SONARD_SIMD_CLONES
bool SlicePatcher::all_even(const Request& request) const {
  const float allowed = request.evenness * request.line_m;
  const float furthest = request.max_range_m;
  const auto count = pieces_.size();
  const float* __restrict low = range_low_.data();
  const float* __restrict mid = range_mid_.data();
  const float* __restrict high = range_high_.data();
  std::int32_t uneven = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float lower = mid[i] - low[i] < 0 ? low[i] - mid[i] : mid[i] - low[i];
    const float upper = high[i] - mid[i] < 0 ? mid[i] - high[i] : high[i] - mid[i];
    const float difference = upper < lower ? lower - upper : upper - lower;
    const bool turns = (mid[i] - low[i]) * (high[i] - mid[i]) < 0;
    const float nearest =
        low[i] < high[i] ? (low[i] < mid[i] ? low[i] : mid[i]) : (high[i] < mid[i] ? high[i] : mid[i]);
    uneven += (((turns ? lower + upper : difference) > allowed) & (nearest < furthest)) ? 1 : 0;
  }
  return uneven == 0;
}

bool SlicePatcher::is_mapped(const Request& request, const VisiblePiece& piece) {
  const NormalPyramid* map = request.parts[request.cutter.triangle(piece.segment).part].normal_map.get();
  return map != nullptr && map->levels.size() > 1;  // one texel has no bumps
}

/// Divides the pieces whose echo is not even in range. Half of a piece's elevation holds about half of its
/// echo: the ranges of the halves tell how uneven it is.
bool SlicePatcher::divide_uneven(const Request& request) {
  if (!request.any_mapped && all_even(request)) {
    return false;
  }
  bool any = false;
  divided_.clear();
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const float lower = range_mid_[i] - range_low_[i];
    const float upper = range_high_[i] - range_mid_[i];
    const float sum = std::abs(lower) + std::abs(upper);
    // Where the range turns round inside, the halves overlap.
    const bool turns = lower * upper < 0;
    int parts = 1;
    const float displaced = turns ? sum : std::abs(std::abs(upper) - std::abs(lower));
    const bool in_range = std::min({range_low_[i], range_mid_[i], range_high_[i]}) < request.max_range_m;
    if (in_range && displaced > request.evenness * request.line_m) {
      // The displacement falls with the square of the length.
      parts = turns ? 4 : 1 + static_cast<int>(std::sqrt(displaced / (request.evenness * request.line_m)));
    }
    if (in_range && sum > mapped_lines * request.line_m && is_mapped(request, pieces_[i])) {
      parts = std::max(parts, 1 + static_cast<int>(sum / (mapped_lines * request.line_m)));
    }
    const VisiblePiece& whole = pieces_[i];
    if (parts == 1) {
      divided_.push_back(whole);
      continue;
    }
    any = true;
    parts = std::min(parts, most_divisions);
    VisiblePiece part = whole;
    for (int k = 1; k <= parts; ++k) {
      const float share = static_cast<float>(k) / static_cast<float>(parts);
      part.high = k == parts ? whole.high : whole.low + (whole.high - whole.low) * share;
      part.high_drift = k == parts ? whole.high_drift : 0.0F;
      if (part.high > part.low) {
        divided_.push_back(part);
        part.low = part.high;
        part.low_drift = part.high_drift;
      }
    }
  }
  pieces_.swap(divided_);
  return any;
}

void SlicePatcher::shade(const Request& request) {
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const VisiblePiece& piece = pieces_[i];
    const FanTriangle& triangle = request.cutter.triangle(piece.segment);
    const PartSurface& part = request.parts[triangle.part];
    const float t = 0.5F * (piece.low + piece.high);
    float cosine = cosine_[i];
    if (part.vertex_normals || part.normal_map) {
      const float h = 1.0F / (w_at_0_[i] + w_slope_[i] * t);
      const PiecePlace place{h, t * h, request.slice, std::abs(range_high_[i] - range_low_[i])};
      cosine = shaded_cosine(part, triangle, place, cosine);
    }
    response_[i] = surface_response(part, request.surface, cosine, range_mid_[i]);
    if (!request.pattern.flat()) {
      solid_angle_[i] *= request.pattern.at(t);
    }
  }
}

/// The probes of each piece, as they run if the piece goes on as it does in the middle.
SONARD_SIMD_CLONES
void SlicePatcher::find_probes(float tan_limit, float offset_rad) {
  const auto count = pieces_.size();
  const float probes_per_t = side_probes / (2 * tan_limit);
  const auto end = static_cast<float>(side_probes);
  const float* __restrict low = low_.data();
  const float* __restrict high = high_.data();
  const float* __restrict low_drift = low_drift_.data();
  const float* __restrict high_drift = high_drift_.data();
  std::int32_t* __restrict first = first_probe_.data();
  std::int32_t* __restrict last = last_probe_.data();
  for (std::size_t i = 0; i < count; ++i) {
    // The first probe at or above t; probes lie in the middle of their steps. Truncation is floor where it
    // counts.
    const float from = (low[i] + low_drift[i] * offset_rad + tan_limit) * probes_per_t + 0.5F;
    const float to = (high[i] + high_drift[i] * offset_rad + tan_limit) * probes_per_t + 0.5F;
    first[i] = static_cast<std::int32_t>(from < 0 ? 0.0F : (from > end ? end : from));
    last[i] = static_cast<std::int32_t>(to < 0 ? 0.0F : (to > end ? end : to));
  }
}

void SlicePatcher::profile(float tan_limit, float offset_rad, SideProfile& out) {
  out.fill(0.0F);
  const float step = 2 * tan_limit / side_probes;
  find_probes(tan_limit, offset_rad);
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    for (std::int32_t k = first_probe_[i]; k < last_probe_[i]; ++k) {
      const float t = -tan_limit + (static_cast<float>(k) + 0.5F) * step;
      out[static_cast<std::size_t>(k)] = w_at_0_[i] + w_by_azimuth_[i] * offset_rad + w_slope_[i] * t;
    }
  }
}

}  // namespace sonard::render
