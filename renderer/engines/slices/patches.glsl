// SPDX-License-Identifier: Apache-2.0
// From a visible segment to an echo over range: the ranges of its ends, their smear across the wedge,
// incidence, solid angle, and the gradient of the echo along the range.

CONSTANT float most_gradient = 1.1F;  // of a segment; 1 if the range turns round at one end

// Relative excess of a plane's mean range over a wedge above its range in the middle: a 24th of r'' / r times
// the width squared, with r = D / (n . d) as a function of the azimuth. 0 for planes seen nearly edge-on,
// whose range is far from straight. h and s are components of the normal over n . d.
SHARED float sagitta_of_plane(float h, float s, float width) {
  float turn = s * width;
  float sagitta = (1.0F / 24.0F) * (h * width * width + 2.0F * turn * turn);
  return both(turn * turn < 2.5e-3F, both(sagitta<1e-3F, sagitta> - 1e-3F)) ? sagitta : 0.0F;
}

// A segment of a plane in a slice: 1 / h = w_at_0 + w_slope * t, unit normal along the slice, across it to
// port, and up.
struct PlaneLine {
  float w_at_0, w_slope;
  float normal_h, normal_s, normal_z;
};

// A point of the segment. On the plane n . p = D the ray (1, 0, t) has 1 / h = (n_h + n_z t) / D and the
// range sqrt(1 + t^2) h.
struct PlanePoint {
  float secant;      // of the elevation: length of (1, 0, t)
  float range_m;     // mean over the wedge
  float by_azimuth;  // change of the range with the azimuth, at the same t, m / rad
  float by_t;        // change of the range with t, m
  float cosine;      // of the incidence
};

SHARED PlanePoint point_of_plane(PlaneLine plane, float t, float width) {
  float w = plane.w_at_0 + plane.w_slope * t;
  float q = 1.0F + t * t;
  float g = sqrt(q);
  float n = plane.normal_h + plane.normal_z * t;
  float r = g / w * (1.0F + sagitta_of_plane(plane.normal_h / n, plane.normal_s / n, width));
  PlanePoint point;
  point.secant = g;
  point.range_m = r;
  point.by_azimuth = -r * plane.normal_s / n;
  point.by_t = r * (t / q - plane.w_slope / w);
  point.cosine = abs(n) / g;
  return point;
}

// What a slice sees of a segment of a plane, over its wedge.
struct PlaneSegment {
  float range_low, range_mid, range_high;  // at the ends and in the middle, m
  float by_azimuth_low, by_azimuth_high;   // change of the ends' ranges with the azimuth, m / rad
  float cosine_low, cosine_mid, cosine_high;
  float solid_angle;
};

// An end that moves by m = dt / d azimuth changes range by dr/d azimuth + m dr/dt (docs/physics.md 2.3,
// equation 2, along the edge).
SHARED PlaneSegment segment_of_plane(PlaneLine plane, float t1, float t2, float low_slope, float high_slope,
                                     float width) {
  PlanePoint p1 = point_of_plane(plane, t1, width);
  PlanePoint p2 = point_of_plane(plane, t2, width);
  PlanePoint pm = point_of_plane(plane, 0.5F * (t1 + t2), width);
  PlaneSegment segment;
  segment.range_low = p1.range_m;
  segment.range_mid = pm.range_m;
  segment.range_high = p2.range_m;
  segment.by_azimuth_low = p1.by_azimuth + p1.by_t * low_slope;
  segment.by_azimuth_high = p2.by_azimuth + p2.by_t * high_slope;
  segment.cosine_low = p1.cosine;
  segment.cosine_mid = pm.cosine;
  segment.cosine_high = p2.cosine;
  segment.solid_angle = (t2 / p2.secant - t1 / p1.secant) * width;
  return segment;
}

// Relative difference of 1 / h below which neighbouring segments belong to one surface: a millimetre or two,
// shorter than a range line.
CONSTANT float one_surface = 1e-4F;

// Whether a segment and the next one, which begins where it ends, belong to one surface. w: their 1 / h there
SHARED bool is_one_surface(float w, float next_w) {
  return abs(w - next_w) < one_surface * w;
}

// By how much the ends of a segment of a length in t turn too far towards or away from each other, so that
// they cross within the wedge. 0: they do not cross.
SHARED float crossing_excess(float low_slope, float high_slope, float length, float width) {
  float difference = high_slope - low_slope;
  float allowed = 2.0F * length / width;
  return difference > allowed ? difference - allowed : (difference < -allowed ? difference + allowed : 0.0F);
}

// Cosines at the ends and in the middle of a segment as its mean and half its relative change.
struct CosineRun {
  float mean, gradient;
};

SHARED CosineRun cosine_run(float low, float middle, float high) {
  CosineRun run;
  run.mean = (low + 4.0F * middle + high) * (1.0F / 6.0F);
  run.gradient = 0.5F * (high - low) / run.mean;
  return run;
}

// Incidence at t with the normal (h, s, z) that shades, of any length.
SHARED float cosine_of_normal(float h, float s, float z, float t) {
  return abs(h + z * t) / sqrt((h * h + s * s + z * z) * (1.0F + t * t));
}

struct RangeSpan {
  float low, high;  // t at the ends
  float range_low, range_mid, range_high;
  float smear_low, smear_high;  // spread of the ends across the wedge, m
  float shrinking;              // change of the length in t over the wedge: |high slope - low slope| * width
  float cosine_gradient;        // if the response is the cosine, otherwise 0
  bool changes_evenly;          // the response is the cosine
};

struct RangeGradient {
  float smear_low, smear_high;  // limited so that ends cross only if the segment shrinks to nothing
  float gradient;               // of the solid angle along the range; 0: constant
  float displaced_m;            // bound of the echo's displacement by a straight range
};

// The range is approximated as quadratic in t, r = rm + half x + sagitta x^2 with x from -1 to 1. The echo
// per metre of range is proportional to the solid angle, (1 + t^2)^(-3/2) dt, over dr; its first order is the
// gradient (docs/physics.md 2.3). A gradient below least_gradient_m / length is dropped.
SHARED RangeGradient gradient_of(RangeSpan span, float least_gradient_m, float furthest_m) {
  float t1 = span.low, t2 = span.high, tm = 0.5F * (t1 + t2);
  float q1 = 1.0F + t1 * t1, q2 = 1.0F + t2 * t2, qm = 1.0F + tm * tm;
  float r1 = span.range_low, rm = span.range_mid, r2 = span.range_high;
  float half_m = 0.5F * (r2 - r1), sagitta = 0.5F * (r1 + r2) - rm;
  float stretch = 0.5F * qm * sqrt(qm) * (1.0F / (q2 * sqrt(q2)) - 1.0F / (q1 * sqrt(q1)));
  float gradient = stretch - 2.0F * sagitta / half_m;
  float length = abs(half_m), steepness = abs(gradient);
  // Ends whose smears differ by more than twice the spread cross within the wedge. That is right if the
  // segment shrinks to nothing, because its neighbour compensates; it is wrong if the range hardly changes
  // along the segment, as on a wall.
  float shrinks = span.shrinking / (t2 - t1);
  float smear = 0.5F * (span.smear_low + span.smear_high);
  float difference = 0.5F * (span.smear_high - span.smear_low);
  float most = length * (2.0F + 1.5F * shrinks);
  float kept = difference > most ? most : (difference < -most ? -most : difference);
  bool has_gradient = both(steepness < most_gradient, smear < length);
  float with_cosine = abs(gradient + span.cosine_gradient);
  float steeper = with_cosine > steepness ? with_cosine : steepness;
  // With a gradient the error is of third order. Spread evenly, the echo lies two thirds of the sagitta too
  // far towards its thin end. All segments of a surface err to the same side, so this counts nine times.
  float left = both(has_gradient, span.changes_evenly) ? sagitta * sagitta / length : 6.0F * abs(sagitta);
  // If the range turns round inside, the halves overlap.
  float both_halves = abs(rm - r1) + abs(r2 - rm);
  bool turns = (rm - r1) * (r2 - rm) < 0.0F;
  float nearest = r1 < r2 ? (r1 < rm ? r1 : rm) : (r2 < rm ? r2 : rm);
  RangeGradient result;
  result.smear_low = smear - kept;
  result.smear_high = smear + kept;
  result.gradient = both(has_gradient, steeper * length > least_gradient_m) ? gradient : 0.0F;
  result.displaced_m = nearest < furthest_m ? (turns ? both_halves : left) : 0.0F;
  return result;
}

// Mean of the elevation pattern over the echo of a segment, from its weights at both ends and in the middle.
// It includes the changes of solid angle, and of the response by `echo_gradient`, along the segment.
SHARED float mean_weight(float t1, float t2, float w1, float wm, float w2, float echo_gradient) {
  float tm = 0.5F * (t1 + t2);
  float q1 = 1.0F + t1 * t1, q2 = 1.0F + t2 * t2, qm = 1.0F + tm * tm;
  float by_low = (1.0F - echo_gradient) / (q1 * sqrt(q1));
  float by_middle = 4.0F / (qm * sqrt(qm));
  float by_high = (1.0F + echo_gradient) / (q2 * sqrt(q2));
  return (w1 * by_low + wm * by_middle + w2 * by_high) / (by_low + by_middle + by_high);
}

CONSTANT float most_divisions_at_once = 16.0F;  // of a segment
CONSTANT int most_division_rounds = 6;          // near a foot point, parts are divided again
CONSTANT float height_in_one_place = 0.25F;     // of the fan's half height, if a segment echoes in one place

// Largest height of a segment that spreads over many range lines, re the fan's half height, if the elevation
// pattern varies. linearity: largest displacement of an echo, lines
SHARED float height_in_many_lines(float linearity) {
  return 0.36F * sqrt(linearity);
}

// What a patch can represent.
struct PatchLimits {
  float displaced_m;  // of the echo, by straight ranges
  float furthest_m;   // segments wholly beyond are not divided
  float half_line_m;
  float mapped_m;                     // extent in range with a normal map, so that bumps are at their ranges
  float facet_slopes;                 // turn of the facets' direction along a segment, in rms slopes
  float height, height_in_one_place;  // in t, by the elevation pattern
};

struct UnevenSegment {
  float height;  // in t
  float range_low, range_mid, range_high;
  float smear_m;  // mean of both ends
  float displaced_m;
  bool has_gradient;  // and its response changes evenly
  bool is_mapped;
  float slopes;  // turn of the facets' direction along it, in rms slopes; 0 if they do not respond
};

// Number of parts into which a segment must be divided.
SHARED int parts_of_segment(UnevenSegment segment, PatchLimits limits) {
  float to_middle = segment.range_mid - segment.range_low;
  float from_middle = segment.range_high - segment.range_mid;
  float span_m = abs(to_middle) + abs(from_middle);
  float parts = 1.0F;
  if (segment.displaced_m > limits.displaced_m) {
    bool turns = to_middle * from_middle < 0.0F;
    // The displacement falls with the square of the length, or with its third power if the echo has a
    // gradient.
    float excess = segment.displaced_m / limits.displaced_m;
    parts = turns ? 2.0F : 1.0F + floor(segment.has_gradient ? cube_root(excess) : sqrt(excess));
  }
  if (least_of(segment.range_low, segment.range_mid, segment.range_high) < limits.furthest_m) {
    if (segment.is_mapped && span_m > limits.mapped_m) {
      parts = max(parts, 1.0F + floor(span_m / limits.mapped_m));
    }
    // Nearly constant echo of facets if a part lies in one line, or nearly linear echo if it spreads over
    // more.
    parts = max(parts, ceil(segment.slopes / (span_m < limits.half_line_m ? 1.0F : limits.facet_slopes)));
    // A nearly linear elevation pattern, or an accurate mean of it if a part echoes in one place.
    bool one_place = span_m < max(limits.half_line_m, segment.smear_m);
    parts = max(parts, ceil(segment.height / (one_place ? limits.height_in_one_place : limits.height)));
  }
  return int(min(parts, most_divisions_at_once));
}

// The t at which the range of a segment turns round: dr/dt = 0 on 1 / h = w_at_0 + w_slope t.
SHARED float turn_of_range(float w_at_0, float w_slope) {
  return w_slope / w_at_0;
}

// High end of the k-th part, from 1, of a segment. Two halves meet where the range turns round.
SHARED float end_of_part(float low, float high, float turn, int k, int parts) {
  bool at_turn = parts == 2 && turn > low && turn < high;
  precise float evenly = low + (high - low) * (float(k) / float(parts));
  return k == parts ? high : (at_turn ? turn : evenly);
}

SHARED float within_one(float gradient) {
  return gradient > 1.0F ? 1.0F : (gradient < -1.0F ? -1.0F : gradient);
}
