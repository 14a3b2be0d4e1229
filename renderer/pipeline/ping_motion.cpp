// SPDX-License-Identifier: Apache-2.0
#include "renderer/pipeline/ping_motion.hpp"

#include <algorithm>
#include <cmath>

namespace sonard::render {

namespace {

constexpr int fewest_spans = 2;
constexpr int most_spans = 4;

}  // namespace

double turn_between_rad(const Pose& a, const Pose& b) {
  const glm::dquat turn = glm::conjugate(a.orientation) * b.orientation;
  return 2 * std::atan2(glm::length(glm::dvec3(turn.x, turn.y, turn.z)), std::abs(turn.w));
}

std::vector<RangeSpan> range_spans(const Pose& at_transmission, const Pose& at_end, int lines,
                                   double receive_beamwidth_rad) {
  const double halves = turn_between_rad(at_transmission, at_end) / (receive_beamwidth_rad / 2);
  // At most one span per line, because a span holds at least one line.
  const int wanted = halves < most_spans ? static_cast<int>(std::ceil(halves)) : most_spans;
  const int count = std::min(std::max(wanted, fewest_spans), lines);
  std::vector<RangeSpan> spans;
  for (int i = 0; i < count; ++i) {
    const int first = static_cast<int>(static_cast<long long>(lines) * i / count);
    const int end = static_cast<int>(static_cast<long long>(lines) * (i + 1) / count);
    const double received = 0.5 * (first + end) / lines;  // middle of the span, as a share of the ping's time
    const glm::dvec3 way = at_end.position_m - at_transmission.position_m;
    spans.push_back(
        {first,
         end,
         {at_transmission.position_m + 0.5 * received * way,
          glm::normalize(glm::slerp(at_transmission.orientation, at_end.orientation, received))}});
  }
  return spans;
}

}  // namespace sonard::render
