// SPDX-License-Identifier: Apache-2.0
// Visibility of two segments of a slice.

CONSTANT float never = 3.4e38F;  // a t that is not reached
// Relative difference of 1 / h below which two segments touch but do not cross; above the rounding of cuts.
CONSTANT float touching = 1e-5F;

// The numbers of a segment that determine visibility.
struct Line {
  int segment;  // -1: no segment
  float high;
  float w_at_0, w_slope;
};

SHARED float w_of(Line line, float t) {
  precise float w = line.w_at_0 + line.w_slope * t;
  return w;
}

// The t after `from` at which two segments cross that both reach over `from`, or `never`.
SHARED float crossing_of(Line a, Line b, float from) {
  float until = min(a.high, b.high);
  precise float w_from = w_of(a, from);
  precise float first = w_from - w_of(b, from);
  precise float last = w_of(a, until) - w_of(b, until);
  float margin = touching * abs(w_from);
  if (!(first * last < 0.0F) || abs(first) < margin || abs(last) < margin) {
    return never;
  }
  precise float at = from + (until - from) * (first / (first - last));
  return at > from && at < until ? at : never;
}

// True if `a` is visible at and after `from`, before `b`. Compared in the middle of the common span, because
// neighbours share ends; if they cross, compared at `from`. `crossing` is crossing_of(a, b, from).
SHARED bool is_seen_first(Line a, Line b, float from, float crossing) {
  if (crossing < never) {
    return w_of(a, from) > w_of(b, from);
  }
  precise float middle = 0.5F * (from + min(a.high, b.high));
  precise float difference = w_of(a, middle) - w_of(b, middle);
  return difference > 0.0F || (difference == 0.0F && a.segment < b.segment);
}
