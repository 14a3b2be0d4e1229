// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/slice_sweep.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

using slices::crossing_of;
using slices::is_seen_first;
using slices::never;
using slices::touching;

constexpr float widest_gap_rad = 2 * slices::shortest_rad;  // left by dropped segments

}  // namespace

void SliceSweep::run(const SliceCutter& cutter, const Slice& slice, const Segments& segments, float tan_limit,
                     std::vector<VisibleSegment>& visible) {
  cutter_ = &cutter;
  segments_ = &segments;
  visible_ = &visible;
  cosine_ = slice.cosine;
  sine_ = slice.sine;
  count_ = segments.kept.size();
  limit_ = tan_limit;
  visible.clear();
  crossed_.clear();
  short_.clear();
  waiting_.clear();
  sort_by_low_end();
  next_ = 0;
  current_ = no_line;
  crossing_ = never;
  t_ = -limit_;
  run_ = {};
  while (t_ < limit_) {
    if (current_.segment < 0) {
      if (next_ == count_) {
        break;
      }
      step_to_next_start();
      continue;
    }
    const float end = std::min(current_.high, limit_);
    const float start = next_start();
    if (crossing_ < start && crossing_ < end) {
      const std::size_t before = visible.size();
      emit(crossing_, {});
      if (visible.size() > before) {
        crossed_.push_back(before);
      }
      std::swap(current_, waiting_[crosser_]);
      find_next_crossing();
    } else if (start < end) {
      meet(line(order_[next_++]));
    } else {
      step_to_end_of_current();
    }
  }
  follow_crossings();
  close_gaps();
}

/// Removes segments that are visible only through a gap in a surface.
void SliceSweep::close_gaps() {
  for (std::size_t k = short_.size(); k-- > 0;) {
    const std::size_t i = short_[k];
    if (i == 0 || i + 1 >= visible_->size()) {
      continue;
    }
    const VisibleSegment& before = (*visible_)[i - 1];
    const VisibleSegment& segment = (*visible_)[i];
    const VisibleSegment& after = (*visible_)[i + 1];
    const float w = segment.w_at_0 + segment.w_slope * segment.low;
    if (before.high == segment.low && segment.high == after.low &&
        before.w_at_0 + before.w_slope * segment.low > w * (1 + touching) &&
        after.w_at_0 + after.w_slope * segment.high > w * (1 + touching)) {
      visible_->erase(visible_->begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
}

/// Sets the runs of segments that end at a crossing: along the line in which the two planes intersect. Its
/// direction e gives dt / d azimuth = (e_z - t e_h) / e_s, as for the edge of a triangle.
void SliceSweep::follow_crossings() {
  for (const std::size_t i : crossed_) {
    if (i + 1 >= visible_->size()) {
      continue;
    }
    VisibleSegment& before = (*visible_)[i];
    VisibleSegment& after = (*visible_)[i + 1];
    const float e_h = before.normal_s * after.normal_z - before.normal_z * after.normal_s;
    const float e_s = before.normal_z * after.normal_h - before.normal_h * after.normal_z;
    const float e_z = before.normal_h * after.normal_s - before.normal_s * after.normal_h;
    const float slope = (e_z - before.high * e_h) / e_s;
    // It moves at most by the length of the longer segment.
    const float reach = std::max(before.high - before.low, after.high - after.low);
    before.high_run = after.low_run = std::isfinite(slope) ? EdgeRun{slope, reach} : EdgeRun{};
  }
}

float SliceSweep::next_start() const {
  return next_ < count_ ? std::max(-limit_, start_[next_]) : never;
}

float SliceSweep::start_after_next() const {
  return next_ + 1 < count_ ? start_[next_ + 1] : never;
}

/// Counting sort into two buckets per segment, then insertion sort: linear if segments are spread over the
/// fan, like the triangles of a surface.
void SliceSweep::sort_by_low_end() {
  const std::size_t count = segments_->kept.size();
  const auto buckets = static_cast<std::int32_t>(std::clamp<std::size_t>(2 * count, 16, 65536));
  for (auto* array : {&order_, &bucket_}) {
    array->resize(std::max(array->size(), count));
  }
  for (auto* array : {&start_, &unsorted_start_}) {
    array->resize(std::max(array->size(), count));
  }
  find_buckets(buckets);
  bucket_begin_.assign(static_cast<std::size_t>(buckets) + 1, 0);
  for (std::size_t i = 0; i < count; ++i) {
    ++bucket_begin_[static_cast<std::size_t>(bucket_[i]) + 1];
  }
  for (std::size_t b = 0; b < static_cast<std::size_t>(buckets); ++b) {
    bucket_begin_[b + 1] += bucket_begin_[b];
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t at = bucket_begin_[static_cast<std::size_t>(bucket_[i])]++;
    order_[at] = segments_->kept[i];
    start_[at] = unsorted_start_[i];
  }
  for (std::size_t i = 1; i < count; ++i) {
    const float start = start_[i];
    if (start_[i - 1] <= start) {
      continue;
    }
    const std::int32_t segment = order_[i];
    std::size_t at = i;
    for (; at > 0 && start_[at - 1] > start; --at) {
      order_[at] = order_[at - 1];
      start_[at] = start_[at - 1];
    }
    order_[at] = segment;
    start_[at] = start;
  }
}

SONARD_SIMD_CLONES
void SliceSweep::find_buckets(std::int32_t buckets) {
  const std::size_t count = segments_->kept.size();
  const float* __restrict low = segments_->low.data();
  const std::int32_t* __restrict kept = segments_->kept.data();
  float* __restrict start = unsorted_start_.data();
  std::int32_t* __restrict bucket = bucket_.data();
  const float limit = limit_;
  const float scale = static_cast<float>(buckets) / (2 * limit);
  const float last = static_cast<float>(buckets - 1);
  for (std::size_t i = 0; i < count; ++i) {
    const float begin = low[kept[i]];
    start[i] = begin;
    const float place = (begin + limit) * scale;
    const float above = place > 0 ? place : 0.0F;
    bucket[i] = static_cast<std::int32_t>(above < last ? above : last);
  }
}

void SliceSweep::emit(float until, const EdgeRun& run) {
  if (until > t_) {
    if (until - t_ < widest_gap_rad * (1 + t_ * t_)) {
      short_.push_back(visible_->size());
    }
    const auto s = static_cast<std::size_t>(current_.segment);
    const float nx = cutter_->normal_x()[s], ny = cutter_->normal_y()[s];
    visible_->push_back({t_, until, current_.w_at_0, current_.w_slope, run_, run, nx * cosine_ + ny * sine_,
                         ny * cosine_ - nx * sine_, cutter_->normal_z()[s], cutter_->part(current_.segment),
                         &cutter_->triangle(current_.segment)});
    t_ = until;
  }
  run_ = run;
}

/// Nothing is visible here: continues at the next begin of a segment.
void SliceSweep::step_to_next_start() {
  t_ = next_start();
  const auto first = static_cast<std::size_t>(order_[next_]);
  run_ = segments_->low[first] > -limit_ ? segments_->low_run(first) : EdgeRun{};
  take_nearest_waiting();
}

/// Handles a segment that begins while another is visible.
void SliceSweep::meet(const Line& line) {
  const auto s = static_cast<std::size_t>(line.segment);
  const float start = std::max(-limit_, segments_->low[s]);
  const float crossing = crossing_of(line, current_, start);
  const bool cross = crossing < never;
  if (is_seen_first(line, current_, start, crossing)) {
    emit(start, segments_->low_run(s));
    if (cross || current_.high > line.high) {
      waiting_.push_back(current_);
    }
    current_ = line;
    find_next_crossing();
  } else if (cross || line.high > current_.high) {
    // Otherwise it ends behind the current one and never becomes visible.
    waiting_.push_back(line);
    if (crossing < crossing_) {
      crossing_ = crossing;
      crosser_ = waiting_.size() - 1;
    }
  }
}

void SliceSweep::step_to_end_of_current() {
  const bool cut_by_limit = current_.high >= limit_;
  emit(std::min(current_.high, limit_),
       cut_by_limit ? EdgeRun{} : segments_->high_run(static_cast<std::size_t>(current_.segment)));
  if (waiting_.empty() && next_start() <= t_ && start_after_next() > t_) {
    // The next facet of one surface, with nothing behind it: the most common case.
    current_ = line(order_[next_++]);
    crossing_ = never;
    return;
  }
  take_nearest_waiting();
}

/// Makes the nearest of all segments at t_ the current one.
void SliceSweep::take_nearest_waiting() {
  while (next_ < count_ && next_start() <= t_) {
    waiting_.push_back(line(order_[next_++]));
  }
  std::size_t kept = 0;
  std::size_t best = 0;
  for (const Line& candidate : waiting_) {
    if (!(candidate.high > t_)) {
      continue;
    }
    waiting_[kept] = candidate;
    if (kept > 0 &&
        is_seen_first(candidate, waiting_[best], t_, crossing_of(candidate, waiting_[best], t_))) {
      best = kept;
    }
    ++kept;
  }
  waiting_.resize(kept);
  current_ = no_line;
  crossing_ = never;
  if (kept > 0) {
    current_ = waiting_[best];
    waiting_[best] = waiting_.back();
    waiting_.pop_back();
    find_next_crossing();
  }
}

SliceSweep::Line SliceSweep::line(std::int32_t segment) const {
  const auto s = static_cast<std::size_t>(segment);
  return {segment, segments_->high[s], segments_->w_at_0[s], segments_->w_slope[s]};
}

void SliceSweep::find_next_crossing() {
  crossing_ = never;
  for (std::size_t k = 0; k < waiting_.size(); ++k) {
    if (!(waiting_[k].high > t_)) {
      continue;
    }
    const float crossing = crossing_of(current_, waiting_[k], t_);
    if (crossing < crossing_) {
      crossing_ = crossing;
      crosser_ = k;
    }
  }
}

}  // namespace sonard::render
