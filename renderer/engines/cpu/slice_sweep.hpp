// SPDX-License-Identifier: Apache-2.0
// Visibility in one slice: an exact sweep over its segments from the lowest elevation to the highest.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/engines/cpu/slice_cutter.hpp"

namespace sonard::render {

/// Visible part of a triangle in a slice, between two elevations.
struct VisibleSegment {
  float low, high;        ///< t at the ends; low < high
  float w_at_0, w_slope;  ///< see Segments
  EdgeRun low_run, high_run;
  float normal_h, normal_s, normal_z;  ///< of the triangle: along the slice, across it to port, and up
  std::uint32_t part;                  ///< of the triangle, copied to avoid a look-up
  const FanTriangle* triangle;
};

/// Finds the nearest segment at every elevation, without sampling elevations: a visible segment ends exactly
/// where it ends, where a nearer one begins, or where two cross. One per thread; reuses its memory.
class SliceSweep {
 public:
  /// Finds the visible segments from -tan_limit to tan_limit, in rising order and without overlap. Of
  /// segments in the same place, the first is visible.
  /// @param segments result of the last cutter.cut(), of `slice`
  void run(const SliceCutter& cutter, const Slice& slice, const Segments& segments, float tan_limit,
           std::vector<VisibleSegment>& visible);

 private:
  using Line = slices::Line;
  static constexpr Line no_line{-1, 0.0F, 0.0F, 0.0F};

  void follow_crossings();
  void close_gaps();
  void sort_by_low_end();
  void find_buckets(std::int32_t buckets);
  void step_to_next_start();
  void step_to_end_of_current();
  void meet(const Line& line);
  void take_nearest_waiting();
  void emit(float until, const EdgeRun& run);
  Line line(std::int32_t segment) const;
  void find_next_crossing();
  float next_start() const;
  float start_after_next() const;

  const SliceCutter* cutter_ = nullptr;
  const Segments* segments_ = nullptr;
  std::vector<VisibleSegment>* visible_ = nullptr;
  float cosine_ = 1.0F, sine_ = 0.0F;  ///< of the azimuth
  float limit_ = 0.0F;
  std::size_t count_ = 0;            ///< of segments; arrays may be longer
  std::vector<std::int32_t> order_;  ///< segments by rising low end
  std::vector<float> start_;         ///< their low ends
  std::vector<float> unsorted_start_;
  std::vector<std::int32_t> bucket_;  ///< of the sort
  std::vector<std::uint32_t> bucket_begin_;
  std::size_t next_ = 0;       ///< in order_
  std::vector<Line> waiting_;  ///< begun, hidden by the current one, and possibly visible later
  Line current_ = no_line;
  float t_ = 0.0F;         ///< position of the sweep, and begin of the current segment
  EdgeRun run_;            ///< at t_
  float crossing_ = 0.0F;  ///< next t at which a waiting segment crosses in front of the current one
  std::size_t crosser_ = 0;
  std::vector<std::size_t> short_;    ///< visible segments that may lie in a gap
  std::vector<std::size_t> crossed_;  ///< visible segments that end at a crossing with the next one
};

}  // namespace sonard::render
