// SPDX-License-Identifier: Apache-2.0
// What is visible in one slice: an exact sweep over its segments from the lowest elevation to the highest.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/engines/cpu/slice_cutter.hpp"

namespace sonard::render {

/// Part of a triangle that the sonar sees in a slice, between two elevations.
struct VisibleSegment {
  float low, high;        ///< t at the ends; low < high
  float w_at_0, w_slope;  ///< see Segments
  EdgeRun low_run, high_run;
  float normal_h, normal_s, normal_z;  ///< of the triangle: along the slice, across it to port, and up
  std::uint32_t part;  ///< of the triangle: most of what is asked of it, without looking it up
  const FanTriangle* triangle;
};

/// Finds the nearest segment at every elevation, without sampling elevations: segments end exactly where a
/// segment ends, where a nearer one begins, or where two cross. One per thread; keeps its memory.
class SliceSweep {
 public:
  /// Segments from -tan_limit to tan_limit in rising order; they do not overlap. Of segments in the same
  /// place the earlier is seen.
  /// @param segments what `cutter` cut out of `slice` last.
  void run(const SliceCutter& cutter, const Slice& slice, const Segments& segments, float tan_limit,
           std::vector<VisibleSegment>& visible);

 private:
  /// What decides which segment is seen.
  struct Line {
    std::int32_t segment = -1;  ///< -1: none
    float high = 0.0F;
    float w_at_0 = 0.0F, w_slope = 0.0F;

    float w(float t) const { return w_at_0 + w_slope * t; }
  };

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
  static bool is_seen_first(const Line& a, const Line& b, float from);
  static bool crosses(const Line& a, const Line& b, float from, float& at);
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
  std::vector<Line> waiting_;  ///< begun, hidden by the current one, and possibly seen later
  Line current_;
  float t_ = 0.0F;         ///< the sweep is here; the current segment began here
  EdgeRun run_;            ///< of that beginning
  float crossing_ = 0.0F;  ///< where a waiting segment comes before the current one
  std::size_t crosser_ = 0;
  std::vector<std::size_t> short_;    ///< segments that may lie in a gap
  std::vector<std::size_t> crossed_;  ///< segments that end where the next one crosses them
};

}  // namespace sonard::render
