// SPDX-License-Identifier: Apache-2.0
// One group for each beam: from the sums of bin.comp to its lines of the image. As RangeProfile::read() and
// BeamSums::read(). The macro WEIGHED is 1 if the weights are summed too.
#include "gpu/echoes.glsl"
#include "gpu/whole_numbers.glsl"
layout(std430, binding = 0) readonly buffer SolidAngles { float solid_angles[]; };  // of the beams, steradians
layout(std430, binding = 1) buffer Counts { PingCounts counts; };
layout(std430, binding = 2) coherent buffer Image { float image[]; };  // [beam][line]; then weights, later open water
layout(std430, binding = 3) readonly buffer Sums { uint sums[]; };     // see bin.comp

const float full_share = 1.0 / 1536.0;  // as in binning.hpp
const float least_open = 2e-3;

shared uvec2 s_slope[GROUP], s_sum[GROUP];
shared float s_weight[GROUP];
shared uint s_negative[GROUP];  // 1: there is a negative line
shared uint s_used;             // 1: something was added to the beam

uint begin, end;  // lines of this invocation
uint beam, lines = uint(echo.lines);

uvec2 difference(int profile, int order, uint line) {
  uint at = 2u * ((uint(2 * profile + order) * uint(ping.beams) + beam) * lines + line);
  return uvec2(sums[at], sums[at + 1u]);
}

// Writes the lines of this invocation from `at` on; they may be negative. All invocations must call it.
void write_sums(int profile, uint at) {
  uvec2 slope = uvec2(0u), sum = uvec2(0u);
  for (int pass = 0; pass < 2; ++pass) {  // to sum up what comes before; to write
    uint used = 0u, below_0 = 0u;
    for (uint k = begin; k < end; ++k) {
      uvec2 first = difference(profile, 0, k), second = difference(profile, 1, k);
      slope = plus(slope, second);
      sum = plus(sum, plus(first, slope));
      used |= first.x | first.y | second.x | second.y;
      if (pass == 1) {
        float value = float_of(sum) * echo.sr_per_unit;
        image[at + k] = value;
        below_0 |= value < 0.0 ? 1u : 0u;
      }
    }
    if (pass == 0) {
      s_slope[lane] = slope;
      s_sum[lane] = sum;
      if (used != 0u) {
        s_used = 1u;
      }
      barrier();
      slope = sum = uvec2(0u);
      for (uint k = 0u; k < lane; ++k) {
        int lines_of_k = int(begin_of_share(lines, k + 1u) - begin_of_share(lines, k));
        sum = plus(sum, plus(s_sum[k], times(slope, lines_of_k)));
        slope = plus(slope, s_slope[k]);
      }
    }
    s_negative[lane] = below_0;
  }
  memoryBarrierBuffer();
  barrier();
}

// If the ends of a patch cross, it is negative on one side and as much too large on the other. A negative line
// becomes 0 and is taken from the lines beside it, so that the beam keeps its whole echo. As RangeProfile::read();
// one invocation visits only negative lines and those that pay for them.
void pay_for_negative_lines(uint at) {
  float missing = 0.0;
  uint paying = 0u;  // end of the earlier lines that can pay
  uint each = begin_of_share(lines, 1u);
  for (uint k = 0u; k < lines;) {
    if (missing == 0.0 && s_negative[k / each] == 0u) {
      k = paying = begin_of_share(lines, k / each + 1u);
      continue;
    }
    float sum = image[at + k], left = sum - missing;
    missing = 0.0;
    if (sum != left || left < 0.0) {
      image[at + k] = max(left, 0.0);
    }
    if (!(left < 0.0)) {
      paying = k + 1u;
    }
    while (left < 0.0 && paying > 0u && image[at + paying - 1u] > 0.0) {
      left += image[at + paying - 1u];
      image[at + paying - 1u] = max(left, 0.0);
      paying -= left > 0.0 ? 0u : 1u;
    }
    if (left < 0.0 && sum != 0.0) {
      missing = -left;  // taken from the next lines
    }
    ++k;
  }
}

// Replaces the weights by the open solid angle in the middle of each line, steradians. All invocations must call it.
void write_open(uint at, float solid_angle) {
  float blocked = 0.0;
  for (uint k = begin; k < end; ++k) {
    blocked += image[at + k];
  }
  s_weight[lane] = blocked;
  barrier();
  float open = solid_angle;
  for (uint k = 0u; k < lane; ++k) {
    open -= s_weight[k];
  }
  for (uint k = begin; k < end; ++k) {
    float weight = image[at + k], here = open - 0.5 * weight;
    image[at + k] = here > least_open * solid_angle ? here : 0.0;
    open -= weight;
  }
}

void main() {
  beam = group_number();
  if (beam >= uint(ping.beams)) {
    return;
  }
  begin = begin_of_share(lines, lane);
  end = begin_of_share(lines, lane + 1u);
  uint echo_at = beam * lines, weights_at = (uint(ping.beams) + beam) * lines;
  if (lane == 0u) {
    s_used = 0u;
  }
  barrier();
  for (int profile = 0; profile <= WEIGHED; ++profile) {
    uint at = profile == 0 ? echo_at : weights_at;
    write_sums(profile, at);
    if (lane == 0u) {
      pay_for_negative_lines(at);
    }
    memoryBarrierBuffer();
    barrier();
  }
  if (lane == 0u && s_used == 0u) {
    atomicAdd(counts.empty_beams, 1u);
  }
#if WEIGHED
  float solid_angle = solid_angles[beam];
  for (uint k = begin; k < end && echo.is_mean != 0; ++k) {
    float weight = max(image[weights_at + k], full_share * solid_angle);
    image[echo_at + k] = min(1.0, image[echo_at + k] / weight);
  }
  if (echo.has_open_water != 0) {
    write_open(weights_at, solid_angle);
  }
#endif
  report_cut_loops();
}
