// SPDX-License-Identifier: Apache-2.0
// From visible segments of a slice to echo patches.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "renderer/binning/echo_patch.hpp"
#include "renderer/engines/cpu/facet_arrays.hpp"
#include "renderer/engines/cpu/slice_facets.hpp"
#include "renderer/engines/cpu/slice_shading.hpp"
#include "renderer/engines/cpu/vertex_normals.hpp"
#include "renderer/engines/cpu/visible_arrays.hpp"
#include "renderer/engines/cpu/visible_ends.hpp"
#include "renderer/engines/slices/elevation_pattern.hpp"
#include "renderer/engines/slices/part_surface.hpp"
#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

/// Makes patches. One per thread; reuses its memory.
class SlicePatcher {
 public:
  struct Request {
    const Slice& slice;
    const std::vector<VisibleSegment>& visible;
    const std::vector<PartSurface>& parts;
    const SurfaceModel& surface;
    const ElevationPattern& pattern;
    float tan_limit;  ///< of the fan's elevation
    /// Within a segment the echo is treated as constant or linear in range. Segments are divided until this
    /// displaces it by at most this many lines.
    float linearity;
    bool any_mapped;  ///< some part has a normal map
    /// With a normal map, segments are at most this many lines long, so that bumps appear at their ranges.
    float mapped_lines;
    const VertexNormals* vertex_normals;  ///< null: no part is shaded by vertex normals
    bool any_facets;                      ///< some part has facets
    /// Segments that spread over lines are divided until the direction of their echo, re the direction of a
    /// mirror, turns by at most this many rms slopes of their facets.
    float facet_slopes;
    /// If facets are stronger at one side of the wedge, the patch moves towards that side. It is divided
    /// across the wedge until the move is at most this many lines.
    float facet_lines;
    float line_m;
    float sampled_range_m;       ///< segments wholly beyond are not divided
    bool within_facets = false;  ///< Sampling::within_facets
  };

  /// @param patches gets the new patches appended
  /// @return number of segments whose facets were left out (SkipRule::facet_kernel)
  std::uint64_t make(const Request& request, std::vector<EchoPatch>& patches);

 private:
  void lay_out(const Request& request);
  void measure(const Request& request);
  void measure_shading();
  void find_gradients(const Request& request);
  bool divide_uneven(const Request& request);
  void divide(std::size_t i, int parts);
  bool mark_uneven(const Request& request);
  static slices::PatchLimits limits_of(const Request& request);
  int parts_of(const Request& request, std::size_t i) const;
  static bool is_mapped(const Request& request, const VisibleSegment& segment);
  void see_normals(const Request& request);
  std::uint64_t shade(const Request& request);
  float shade_plainly(const Request& request, std::size_t i);
  bool add_facets(const Request& request, std::size_t i);
  FacetSight sight_of(const Request& request, std::size_t i) const;
  void add_patches(const Request& request, std::size_t i, std::vector<EchoPatch>& patches) const;
  void weigh_by_pattern(const ElevationPattern& pattern);
  void join_gradients();

  /// Segments after division, and numbers per segment; arrays are as long as in `seen_`.
  const std::vector<VisibleSegment>* visible_ = nullptr;  ///< the request's, or whole_
  std::vector<VisibleSegment> whole_, divided_;
  /// Normals of each segment of the request; empty if all are shaded by their planes and have no facets.
  std::vector<NormalRun> runs_;
  std::vector<std::uint32_t> original_, divided_original_;  ///< per segment: its index in `runs_`
  NormalArrays normals_;                                    ///< `runs_` per segment, if not empty
  FacetArrays facets_;
  VisibleArrays seen_;
  VisibleEnds ends_;
  std::vector<float> range_low_, range_mid_, range_high_, smear_low_, smear_high_, cosine_, solid_angle_;
  std::vector<float> by_azimuth_low_, by_azimuth_high_;  ///< change of the ends' ranges with the azimuth
  std::vector<float> plain_;            ///< 1 if the response is cosine_, which changes evenly; else 0
  std::vector<float> range_gradient_;   ///< of the solid angle along the range, see EchoPatch; 0: constant
  std::vector<float> cosine_gradient_;  ///< of cosine_, the mean of a segment
  std::vector<float> cosine_mid_;       ///< cosine in the middle of a segment
  std::vector<float>
      echo_gradient_;  ///< gradient of the response; after join_gradients(), with range_gradient_
  std::vector<std::int32_t> parts_;  ///< parts into which a segment is divided; 0: not decided
  std::vector<float> displaced_;     ///< bound of the echo's displacement by linearity, metres
  std::vector<float> response_, response_without_facets_;
  std::vector<float> centroid_offset_;   ///< centroid of the echo in its wedge, 1/2 at the port side
  std::vector<MappedIncidence> mapped_;  ///< in the middle of a segment
};

}  // namespace sonard::render
