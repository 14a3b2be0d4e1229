// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/slice_patches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "renderer/engines/cpu/facet_extent.hpp"
#include "renderer/engines/cpu/slice_shading.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

constexpr float anything = std::numeric_limits<float>::infinity();

}  // namespace

std::uint64_t SlicePatcher::make(const Request& request, std::vector<EchoPatch>& patches) {
  visible_ = &request.visible;
  see_normals(request);
  int rounds = 0;
  do {
    lay_out(request);
    ends_.run_straight(request.slice.width_rad, request.tan_limit, seen_);
    measure(request);
    if (!runs_.empty()) {
      measure_shading();
    }
    if (request.any_facets) {
      facets_.lay_out(*visible_, request.parts, request.surface.facets == Facets::everywhere);
      facets_.find_turns(seen_, normals_, request.slice.width_rad);
    }
    find_gradients(request);
  } while (rounds++ < slices::most_division_rounds && divide_uneven(request));
  if (request.any_facets) {
    facets_.respond(seen_, normals_, request.slice.width_rad);
  }
  const std::uint64_t without_facets = shade(request);
  for (std::size_t i = 0; i < visible_->size(); ++i) {
    const std::size_t first = patches.size();
    add_patches(request, i, patches);
    if (request.within_facets) {
      const auto extent = facet_extent(*(*visible_)[i].triangle, request.slice);
      for (std::size_t k = first; extent && k < patches.size(); ++k) {
        keep_within(*extent, patches[k]);
      }
    }
  }
  return without_facets;
}

/// Finds the normals of all segments, if any segment has facets or is shaded by vertex normals. The parts of
/// a divided segment share its normals.
void SlicePatcher::see_normals(const Request& request) {
  runs_.clear();
  original_.clear();
  if (request.vertex_normals == nullptr && !request.any_facets) {
    return;
  }
  bool any_shaded = false;
  for (const VisibleSegment& segment : *visible_) {
    NormalRun run{{segment.normal_h, segment.normal_s, segment.normal_z}};
    const PartSurface& part = request.parts[segment.part];
    const bool is_shaded = request.vertex_normals != nullptr && part.vertex_normals &&
                           !part.mesh->normals.empty() && !is_mapped(request, segment);
    if (is_shaded) {
      NormalRun smooth = request.vertex_normals->run(*segment.triangle, request.slice);
      if (!part.refraction_in_part.straight()) {
        refract(part, segment, request.slice, 0.5F * (segment.low + segment.high), smooth);
      }
      run = smooth.is_finite() ? smooth : run;
      any_shaded = true;
    }
    original_.push_back(static_cast<std::uint32_t>(runs_.size()));
    runs_.push_back(run);
  }
  if (!any_shaded && !request.any_facets) {
    runs_.clear();
    original_.clear();
  }
}

/// Adds one patch, or several side by side if facets are much stronger at one side of the wedge.
void SlicePatcher::add_patches(const Request& request, std::size_t i, std::vector<EchoPatch>& patches) const {
  const EchoPatch whole{
      range_low_[i],   range_high_[i],    smear_low_[i],      smear_high_[i], response_[i] * solid_angle_[i],
      solid_angle_[i], echo_gradient_[i], range_gradient_[i], seen_.low[i],   seen_.high[i]};
  patches.push_back(whole);
  if (!request.any_facets || centroid_offset_[i] == 0.0F) {
    return;
  }
  const float by_wedge_m = 0.5F * (by_azimuth_low_[i] + by_azimuth_high_[i]) * request.slice.width_rad;
  const float allowed_m = request.facet_lines * request.line_m;
  if (std::abs(by_wedge_m * centroid_offset_[i]) < 0.25F * allowed_m &&
      facets_.turn_across_rad(i) * range_mid_[i] * request.slice.width_rad < allowed_m) {
    patches.back().range_a_m += by_wedge_m * centroid_offset_[i];
    patches.back().range_b_m += by_wedge_m * centroid_offset_[i];
    return;
  }
  const float t = 0.5F * (seen_.low[i] + seen_.high[i]);
  const FacetSight sight = sight_of(request, i);
  const float wedge_m = range_mid_[i] * request.slice.width_rad;
  const float moved_m = wedge_m * sight.range_slope(t, 0.0F) * centroid_offset_[i];
  const float facets_share = 1 - response_without_facets_[i] / response_[i];
  const float sagitta_m =
      0.125F * wedge_m * facets_share * (sight.range_slope(t, 0.5F) - sight.range_slope(t, -0.5F));
  const auto count = static_cast<float>(slices::patches_side_by_side(moved_m, sagitta_m, allowed_m));
  if (count == 1.0F) {
    patches.back().range_a_m += moved_m;
    patches.back().range_b_m += moved_m;
    return;
  }
  patches.pop_back();
  std::array<SegmentFacets, FacetSight::most_parts> of_parts;
  const std::span parts = std::span(of_parts).first(static_cast<std::size_t>(count));
  sight.respond((*visible_)[i], parts);
  float place = 0.5F / count - 0.5F;  // middle of the part
  for (const SegmentFacets& facets : parts) {
    const float response = response_without_facets_[i] + facets.mean;
    const float centroid_offset = response > 0 ? facets.moment / response : 0.0F;
    EchoPatch patch = whole;
    patch.weight /= count;
    patch.echo = response * patch.weight;
    const auto put = [&](float end_t, float& range_m, float& smear_m) {
      // The range at the azimuth of the slice instead of the mean over the wedge.
      const float n = seen_.normal_h[i] + seen_.normal_z[i] * end_t;
      range_m /=
          1 + slices::sagitta_of_plane(seen_.normal_h[i] / n, seen_.normal_s[i] / n, request.slice.width_rad);
      const float wedge_there_m = range_m * request.slice.width_rad;
      const float slope = sight.range_slope(end_t, place);
      const float on_the_way =
          sight.range_slope(end_t, 0.0F) + 4 * sight.range_slope(end_t, 0.5F * place) + slope;
      range_m += wedge_there_m * (place * on_the_way * (1.0F / 6) + slope * centroid_offset);
      smear_m = wedge_there_m * std::abs(slope) / count;
    };
    put(seen_.low[i], patch.range_a_m, patch.smear_a_m);
    put(seen_.high[i], patch.range_b_m, patch.smear_b_m);
    patches.push_back(patch);
    place += 1 / count;
  }
}

void SlicePatcher::lay_out(const Request& request) {
  seen_.lay_out(*visible_);
  // plain_ grows last: if memory runs out before, the next call tries all again.
  if (seen_.size() > plain_.size()) {
    for (auto* array :
         {&range_low_, &range_mid_, &range_high_, &smear_low_, &smear_high_, &cosine_, &solid_angle_,
          &response_, &range_gradient_, &cosine_gradient_, &cosine_mid_, &echo_gradient_, &displaced_,
          &by_azimuth_low_, &by_azimuth_high_, &centroid_offset_, &response_without_facets_}) {
      array->resize(seen_.size());
    }
    mapped_.resize(seen_.size());
    parts_.resize(seen_.size());
    plain_.resize(seen_.size());
  }
  const bool as_cosine = request.surface.model == Model::physical;
  for (std::size_t i = 0; i < seen_.count; ++i) {
    plain_[i] = as_cosine && !is_mapped(request, (*visible_)[i]) ? 1.0F : 0.0F;
  }
  if (!runs_.empty()) {
    normals_.lay_out(runs_, original_);
  }
}

/// Computes ranges at both ends and in the middle, smears of the ends, incidence and solid angle.
SONARD_SIMD_CLONES
void SlicePatcher::measure(const Request& request) {
  const float width = request.slice.width_rad;
  const auto count = visible_->size();
  const float* __restrict low = seen_.low.data();
  const float* __restrict high = seen_.high.data();
  const float* __restrict low_slope = seen_.low_slope.data();
  const float* __restrict high_slope = seen_.high_slope.data();
  const float* __restrict w_at_0 = seen_.w_at_0.data();
  const float* __restrict w_slope = seen_.w_slope.data();
  const float* __restrict normal_h = seen_.normal_h.data();
  const float* __restrict normal_s = seen_.normal_s.data();
  const float* __restrict normal_z = seen_.normal_z.data();
  float* __restrict range_low = range_low_.data();
  float* __restrict range_high = range_high_.data();
  float* __restrict smear_low = smear_low_.data();
  float* __restrict smear_high = smear_high_.data();
  float* __restrict by_azimuth_low = by_azimuth_low_.data();
  float* __restrict by_azimuth_high = by_azimuth_high_.data();
  float* __restrict range_mid = range_mid_.data();
  float* __restrict cos_phi = cosine_.data();
  float* __restrict solid_angle = solid_angle_.data();
  float* __restrict cosine_gradient = cosine_gradient_.data();
  float* __restrict cosine_mid = cosine_mid_.data();
  for (std::size_t i = 0; i < count; ++i) {
    const slices::PlaneLine plane{w_at_0[i], w_slope[i], normal_h[i], normal_s[i], normal_z[i]};
    const slices::PlaneSegment segment =
        slices::segment_of_plane(plane, low[i], high[i], low_slope[i], high_slope[i], width);
    range_low[i] = segment.range_low;
    range_mid[i] = segment.range_mid;
    range_high[i] = segment.range_high;
    by_azimuth_low[i] = segment.by_azimuth_low;
    by_azimuth_high[i] = segment.by_azimuth_high;
    smear_low[i] = std::abs(segment.by_azimuth_low) * width;
    smear_high[i] = std::abs(segment.by_azimuth_high) * width;
    const slices::CosineRun cosine =
        slices::cosine_run(segment.cosine_low, segment.cosine_mid, segment.cosine_high);
    cos_phi[i] = cosine.mean < 1 ? cosine.mean : 1.0F;
    cosine_gradient[i] = cosine.gradient;
    cosine_mid[i] = segment.cosine_mid;
    solid_angle[i] = segment.solid_angle;
  }
}

/// Computes incidence with the normals that shade.
SONARD_SIMD_CLONES
void SlicePatcher::measure_shading() {
  const auto count = visible_->size();
  const float* __restrict low = seen_.low.data();
  const float* __restrict high = seen_.high.data();
  const float* __restrict at_h = normals_.at_h.data();
  const float* __restrict at_s = normals_.at_s.data();
  const float* __restrict at_z = normals_.at_z.data();
  const float* __restrict h_per_t = normals_.h_per_t.data();
  const float* __restrict s_per_t = normals_.s_per_t.data();
  const float* __restrict z_per_t = normals_.z_per_t.data();
  float* __restrict cos_phi = cosine_.data();
  float* __restrict cosine_gradient = cosine_gradient_.data();
  float* __restrict cosine_mid = cosine_mid_.data();
  for (std::size_t i = 0; i < count; ++i) {
    const auto cosine_at = [&](float t) {
      const float h = at_h[i] + h_per_t[i] * t, s = at_s[i] + s_per_t[i] * t, z = at_z[i] + z_per_t[i] * t;
      return slices::cosine_of_normal(h, s, z, t);
    };
    const float c1 = cosine_at(low[i]), c2 = cosine_at(high[i]), cm = cosine_at(0.5F * (low[i] + high[i]));
    const slices::CosineRun cosine = slices::cosine_run(c1, cm, c2);
    const bool is_direction = cosine.mean >= 0;  // otherwise the plane's cosine stays
    cos_phi[i] = is_direction ? (cosine.mean < 1 ? cosine.mean : 1.0F) : cos_phi[i];
    cosine_gradient[i] = is_direction ? cosine.gradient : cosine_gradient[i];
    cosine_mid[i] = is_direction ? cm : cosine_mid[i];
  }
}

/// Computes the gradient of the echo along the range, and the error that remains. The range is approximated
/// as quadratic in t, r = rm + half x + sagitta x^2 with x from -1 to 1. The echo per metre of range is
/// proportional to the solid angle, (1 + t^2)^(-3/2) dt, over dr; its first order is the gradient
/// (docs/physics.md 2.3).
SONARD_SIMD_CLONES
void SlicePatcher::find_gradients(const Request& request) {
  const auto count = visible_->size();
  const float* __restrict low = seen_.low.data();
  const float* __restrict high = seen_.high.data();
  const float* __restrict range_low = range_low_.data();
  const float* __restrict range_mid = range_mid_.data();
  const float* __restrict range_high = range_high_.data();
  float* __restrict smear_low = smear_low_.data();
  float* __restrict smear_high = smear_high_.data();
  const float* __restrict cosine_gradient = cosine_gradient_.data();
  const float* __restrict plain = plain_.data();
  float* __restrict range_gradient = range_gradient_.data();
  float* __restrict displaced = displaced_.data();
  const float* __restrict low_slope = seen_.low_slope.data();
  const float* __restrict high_slope = seen_.high_slope.data();
  const float width = request.slice.width_rad;
  const float furthest = request.sampled_range_m;
  // A gradient moves the middle of the echo by a third of this.
  const float least_gradient_m = 0.5F * request.linearity * request.line_m;
  for (std::size_t i = 0; i < count; ++i) {
    const slices::RangeGradient gradient =
        slices::gradient_of({.low = low[i],
                             .high = high[i],
                             .range_low = range_low[i],
                             .range_mid = range_mid[i],
                             .range_high = range_high[i],
                             .smear_low = smear_low[i],
                             .smear_high = smear_high[i],
                             .shrinking = std::abs(high_slope[i] - low_slope[i]) * width,
                             .cosine_gradient = plain[i] * cosine_gradient[i],
                             .changes_evenly = plain[i] > 0},
                            least_gradient_m, furthest);
    smear_low[i] = gradient.smear_low;
    smear_high[i] = gradient.smear_high;
    range_gradient[i] = gradient.gradient;
    displaced[i] = gradient.displaced_m;
  }
}

/// Sets `parts_` to 0 for the few segments that need parts_of(), else to 1.
/// @return true if any segment needs parts_of()
SONARD_SIMD_CLONES
bool SlicePatcher::mark_uneven(const Request& request) {
  const auto count = visible_->size();
  const float allowed_m = request.linearity * request.line_m;
  const slices::PatchLimits limits = limits_of(request);
  const float most_height = std::min(limits.height, limits.height_in_one_place);
  const float most_slopes = request.any_facets ? std::min(1.0F, request.facet_slopes) : anything;
  const std::int32_t otherwise = request.any_mapped ? 0 : 1;
  const float* __restrict low = seen_.low.data();
  const float* __restrict high = seen_.high.data();
  const float* __restrict displaced = displaced_.data();
  const float* __restrict slopes_per_t = request.any_facets ? facets_.slopes_per_t() : displaced;
  std::int32_t* __restrict parts = parts_.data();
  std::int32_t marked = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float height = high[i] - low[i];
    const bool is_uneven =
        (displaced[i] > allowed_m) | (height > most_height) | (slopes_per_t[i] * height > most_slopes);
    parts[i] = is_uneven ? 0 : otherwise;
    marked += 1 - parts[i];
  }
  return marked > 0;
}

bool SlicePatcher::is_mapped(const Request& request, const VisibleSegment& segment) {
  const NormalPyramid* map = request.parts[segment.part].normal_map.get();
  return map != nullptr && map->levels.size() > 1;  // one texel has no bumps
}

slices::PatchLimits SlicePatcher::limits_of(const Request& request) {
  const bool varies = request.pattern.varies();
  return {.displaced_m = request.linearity * request.line_m,
          .furthest_m = request.sampled_range_m,
          .half_line_m = 0.5F * request.line_m,
          .mapped_m = request.mapped_lines * request.line_m,
          .facet_slopes = request.facet_slopes,
          .height = varies ? slices::height_in_many_lines(request.linearity) * request.tan_limit : anything,
          .height_in_one_place = varies ? slices::height_in_one_place * request.tan_limit : anything};
}

/// Number of parts into which a segment must be divided.
int SlicePatcher::parts_of(const Request& request, std::size_t i) const {
  const float height = seen_.high[i] - seen_.low[i];
  const bool may_respond = request.any_facets && facets_.may_respond(i);
  return slices::parts_of_segment({.height = height,
                                   .range_low = range_low_[i],
                                   .range_mid = range_mid_[i],
                                   .range_high = range_high_[i],
                                   .smear_m = 0.5F * (smear_low_[i] + smear_high_[i]),
                                   .displaced_m = displaced_[i],
                                   .has_gradient = plain_[i] > 0 && range_gradient_[i] != 0.0F,
                                   .is_mapped = request.any_mapped && is_mapped(request, (*visible_)[i]),
                                   .slopes = may_respond ? facets_.slopes_per_t()[i] * height : 0.0F},
                                  limits_of(request));
}

/// Divides the segments whose echo over range a patch cannot represent. @return false if it divided nothing
bool SlicePatcher::divide_uneven(const Request& request) {
  if (!mark_uneven(request)) {
    return false;
  }
  bool any = false;
  for (std::size_t i = 0; i < visible_->size(); ++i) {
    parts_[i] = parts_[i] != 1 ? parts_of(request, i) : 1;
    any = any || parts_[i] != 1;
  }
  if (!any) {
    return false;
  }
  divided_.clear();
  divided_original_.clear();
  for (std::size_t i = 0; i < visible_->size(); ++i) {
    if (parts_[i] == 1) {
      divided_.push_back((*visible_)[i]);
    } else {
      divide(i, parts_[i]);
    }
    if (!runs_.empty()) {
      divided_original_.resize(divided_.size(), original_[i]);
    }
  }
  whole_.swap(divided_);
  original_.swap(divided_original_);
  visible_ = &whole_;
  return true;
}

/// Puts the parts of a segment into `divided_`.
void SlicePatcher::divide(std::size_t i, int parts) {
  const VisibleSegment& whole = (*visible_)[i];
  VisibleSegment part = whole;
  const float turn = slices::turn_of_range(seen_.w_at_0[i], seen_.w_slope[i]);
  for (int k = 1; k <= parts; ++k) {
    part.high = slices::end_of_part(whole.low, whole.high, turn, k, parts);
    part.high_run = k == parts ? whole.high_run : EdgeRun{};
    if (part.high > part.low) {
      divided_.push_back(part);
      part.low = part.high;
      part.low_run = part.high_run;
    }
  }
}

/// @return number of segments whose facets were left out
std::uint64_t SlicePatcher::shade(const Request& request) {
  std::uint64_t without_facets = 0;
  const bool any_facets = request.any_facets;
  for (std::size_t i = 0; i < visible_->size(); ++i) {
    response_[i] = shade_plainly(request, i);
    echo_gradient_[i] = cosine_gradient_[i] * plain_[i];
    centroid_offset_[i] = 0.0F;
    without_facets += any_facets && add_facets(request, i) ? 0 : 1;
  }
  if (!request.pattern.flat()) {
    weigh_by_pattern(request.pattern);
  }
  join_gradients();
  return without_facets;
}

SONARD_SIMD_CLONES
void SlicePatcher::join_gradients() {
  const auto count = visible_->size();
  float* __restrict range_gradient = range_gradient_.data();
  float* __restrict echo_gradient = echo_gradient_.data();
  for (std::size_t i = 0; i < count; ++i) {
    const float kept = slices::within_one(range_gradient[i] + echo_gradient[i]);
    echo_gradient[i] = range_gradient[i] != 0.0F ? kept : 0.0F;
    range_gradient[i] = slices::within_one(range_gradient[i]);
  }
}

/// Response of a segment without facets.
float SlicePatcher::shade_plainly(const Request& request, std::size_t i) {
  const VisibleSegment& segment = (*visible_)[i];
  const PartSurface& part = request.parts[segment.part];
  float cosine = cosine_[i];
  if (part.normal_map) {
    const float t = 0.5F * (segment.low + segment.high);
    const float h = 1.0F / (seen_.w_at_0[i] + seen_.w_slope[i] * t);
    const SegmentPlace place{h, t * h, request.slice, std::abs(range_high_[i] - range_low_[i])};
    // In the middle of the segment; the ratio of mean and middle follows from geometry.
    const float middle = cosine_mid_[i];
    mapped_[i] = {middle, 1.0F};
    if (middle > 0) {
      mapped_[i] = mapped_incidence(part, *segment.triangle, place, middle);
      cosine = mapped_[i].cosine * (cosine / middle);
    }
  }
  return surface_response(part, request.surface, cosine, range_mid_[i]);
}

/// @return false if the segment has no facets to add
bool SlicePatcher::add_facets(const Request& request, std::size_t i) {
  const VisibleSegment& segment = (*visible_)[i];
  const PartSurface& part = request.parts[segment.part];
  if (part.normal_map) {
    if (request.surface.facets != Facets::everywhere && !(part.backscatter.facet_strength > 0)) {
      return false;
    }
    const float length = mapped_[i].mean_length;
    response_[i] +=
        part.backscatter.facets(std::min(mapped_[i].cosine / length, 1.0F), variance_of_mean_normal(length));
    return true;
  }
  if (!facets_.may_respond(i)) {
    return false;
  }
  SegmentFacets facets{facets_.mean(i), facets_.moment(i), facets_.gradient(i)};
  if (facets_.is_wide(i)) {
    sight_of(request, i).respond(segment, {&facets, 1});
  }
  response_without_facets_[i] = response_[i];
  response_[i] += facets.mean;
  if (response_[i] > 0) {
    echo_gradient_[i] =
        (echo_gradient_[i] * response_without_facets_[i] + 0.5F * facets.gradient) / response_[i];
    centroid_offset_[i] = facets.moment / response_[i];
  }
  return true;
}

FacetSight SlicePatcher::sight_of(const Request& request, std::size_t i) const {
  const VisibleSegment& segment = (*visible_)[i];
  return {request.parts[segment.part].backscatter, runs_[original_[i]], request.slice.width_rad,
          facets_.slopes_across(i)};
}

/// Weights each segment with the mean of the pattern over its echo, and adds the pattern's gradient. The mean
/// includes the changes of solid angle and response along the segment.
SONARD_SIMD_CLONES
void SlicePatcher::weigh_by_pattern(const ElevationPattern& pattern) {
  const auto count = visible_->size();
  const float* __restrict low = seen_.low.data();
  const float* __restrict high = seen_.high.data();
  const float* __restrict echo_gradient = echo_gradient_.data();
  float* __restrict solid_angle = solid_angle_.data();
  float* __restrict range_gradient = range_gradient_.data();
  const float* __restrict table = pattern.table();
  const float per_t = pattern.steps_per_t(), at_0 = pattern.step_at_0(), last = 2 * at_0 - 1e-3F;
  for (std::size_t i = 0; i < count; ++i) {
    const auto weight_at = [&](float t) {
      const float anywhere = t * per_t + at_0;
      const float place = anywhere > 0 ? (anywhere < last ? anywhere : last) : 0.0F;
      const auto step = static_cast<std::int32_t>(place);
      const float rest = place - static_cast<float>(step);
      return table[step] * (1 - rest) + table[step + 1] * rest;
    };
    const float t1 = low[i], t2 = high[i];
    const float w1 = weight_at(t1), w2 = weight_at(t2), wm = weight_at(0.5F * (t1 + t2));
    const float weight = slices::mean_weight(t1, t2, w1, wm, w2, echo_gradient[i]);
    solid_angle[i] *= weight;
    const float steeper = range_gradient[i] + 0.5F * (w2 - w1) / weight;
    range_gradient[i] = ((range_gradient[i] != 0.0F) & (weight > 0)) ? steeper : range_gradient[i];
  }
}

}  // namespace sonard::render
