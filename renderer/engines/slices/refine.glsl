// SPDX-License-Identifier: Apache-2.0
// Comparison of neighbouring slices on their border, and the number of parts into which a slice is divided.

// What two neighbours expect at one probe of their border. `w` is 1 / horizontal distance, 0 if nothing is
// seen.
struct ProbePair {
  float port_far, port_near;            // w of the port slice at its port side, and on the border
  float starboard_near, starboard_far;  // w of the starboard slice on the border, and at its starboard side
  float secant;                         // of the elevation: range = secant / w
  int weight;                           // by the elevation pattern
};

// Limits of the comparison. A sagitta over a chord of width b is b^2 / 8 of the curvature, here the change of
// slope over the mean width of the two slices.
struct BorderLimits {
  float line_m, furthest_m, most_sagitta_m;
  float per_port, per_starboard;  // mean width / (8 width) of each slice
};

struct ProbeDisagreement {
  int mismatched;  // the probe's weight if the ranges differ by more than a line, otherwise 0
  int curved;      // likewise if the surface curves too much for straight lines across the slices
};

// Ranges are compared without division, and ignored if both are out of range.
SHARED ProbeDisagreement compare_probe(ProbePair w, BorderLimits limits) {
  float w_a = w.port_near, w_b = w.starboard_near;
  float nearer = w_a > w_b ? w_a : w_b;
  float product = w_a * w_b;
  float difference = w.secant * (w_a > w_b ? w_a - w_b : w_b - w_a);
  float sagitta =
      w.secant * abs((w.port_far - w_a) * limits.per_port - (w_b - w.starboard_far) * limits.per_starboard);
  bool all_seen = both(both(w.port_far > 0.0F, product > 0.0F), w.starboard_far > 0.0F);
  bool in_range = w.secant < limits.furthest_m * nearer;
  float displaced = sagitta > difference ? sagitta : difference;
  ProbeDisagreement result;
  result.mismatched = both(in_range, difference > limits.line_m * product) ? w.weight : 0;
  result.curved = both(both(in_range, all_seen), displaced > limits.most_sagitta_m * product) ? w.weight : 0;
  return result;
}

// Echo of an elevation times its range. The echo is proportional to cos(incidence) / r^2. With s the slope of
// the range along the slice, from one probe to the next, the cosine is approximated as 1 / (1 + |s|):
// accurate enough as a weight of errors, and without a root.
SHARED float moment_of(float w, float next_w, float secant, float next_secant, float furthest_m,
                       float probes_per_t, float pattern) {
  const float tiny = 1e-30F;                             // avoids 0 / 0 if nothing is seen
  float next = next_secant * w, here = secant * next_w;  // proportional to the ranges there and here
  float steps = next > here ? next - here : here - next;
  float cosine = here / (here + steps * (probes_per_t * secant * secant) + tiny);
  return secant < furthest_m * w ? cosine * w * pattern : 0.0F;
}

// Odd, so that the middle part keeps the visible segments of the whole. Five parts close in on an edge; for a
// sagitta, which falls with the square of the width, three do.
CONSTANT int parts_at_edges = 5;
CONSTANT int parts_of_curves = 3;
CONSTANT float three_helps_by = 9.0F;    // the error falls with the width, and its share of a beam once more
CONSTANT float curves_per_edge = 10.0F;  // a sagitta displaces echoes only a little, an edge hides them
CONSTANT float ends_per_edge = 1.0F;     // at the end of the range, smears are right in first order
CONSTANT float lone_share = 0.6F;        // of the elevations with an echo, at which neighbours disagree
CONSTANT float tall_share = 0.05F;    // of the height of the fan: what is thin and as tall must not be missed
CONSTANT float least_missed = 1e-6F;  // in t, counts for the height of whatever is missed
CONSTANT float least_ensonified = 0.5F / float(side_probes);

// Constants of a ping, from its preset.
struct DivisionLimits {
  int most_divisions;                 // of a beam
  int most_divisions_of_lone_echoes;  // of a beam, if the slice disagrees over most of its elevations
  float disagreement;                 // allowed share of elevations
  float shift_lines;                  // allowed move of the centroid, lines
};

// A slice between its neighbours. Shares are of elevations, weighted by the elevation pattern.
struct SliceErrors {
  float share_of_beam;    // width / width of the beam
  float beam_ensonified;  // share at which the beam receives an echo
  float beam_in_error;    // effective number of slices that share the error of the beam
  float mismatch;         // larger share of both borders at which ranges differ by more than a line
  float curvature;        // larger share of both borders at which surfaces curve
  float shift_lines;      // larger move of the centroid by the mismatch of a border
  float ensonified;       // share at which the slice receives an echo
  float one_sided;        // share at which only one side does
  float missed_share;     // of the fan's height, by a thin thing in the wedge beside the slice; 0: none
};

// Number of parts into which a slice must be divided: at borders where it disagrees too much with a
// neighbour, if it misses a thin thing, and if the range ends in it. Errors are relative to the elevations at
// which the beam receives an echo, and add like independent errors.
SHARED int parts_of_slice(SliceErrors slice, DivisionLimits limits) {
  float most_alone = lone_share * slice.beam_ensonified;
  bool lone =
      max(slice.mismatch, slice.curvature) > most_alone || slice.missed_share > min(most_alone, tall_share);
  int most_divisions = lone ? limits.most_divisions_of_lone_echoes : limits.most_divisions;
  if (slice.share_of_beam * float(most_divisions) < 1.5F) {
    return 1;
  }
  float most = limits.disagreement * slice.beam_ensonified / slice.share_of_beam;
  float most_mismatch = most / sqrt(slice.beam_in_error);
  bool misses_something = slice.missed_share > 0.0F;
  bool shifted = slice.shift_lines * slice.share_of_beam > limits.shift_lines;
  float ending = slice.one_sided * slice.one_sided / max(slice.ensonified, least_ensonified);
  if (misses_something || slice.mismatch > most_mismatch || shifted) {
    bool three_will_do = !misses_something && slice.mismatch < three_helps_by * most_mismatch;
    return three_will_do ? parts_of_curves : parts_at_edges;
  }
  return slice.curvature > curves_per_edge * most || ending > ends_per_edge * most ? parts_of_curves : 1;
}
