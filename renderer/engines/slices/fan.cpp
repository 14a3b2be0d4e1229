// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/slices/fan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sonard::render {

namespace {
constexpr int buckets_per_beam = 16;
}

Fan::Fan(const Aperture& aperture, double sampled_range_m)
    : edges_rad_(aperture.beam_edges_rad),
      tan_limit_(static_cast<float>(std::tan(aperture.elevation_limit_rad()))) {
  const double port = edges_rad_.front(), starboard = edges_rad_.back(), width = port - starboard;
  width_rad_ = static_cast<float>(width);
  space_ = {.sampled_range_m = static_cast<float>(sampled_range_m),
            .sin_limit = static_cast<float>(std::sin(aperture.elevation_limit_rad())),
            .cos_limit = static_cast<float>(std::cos(aperture.elevation_limit_rad())),
            .is_convex = width_rad_ < std::numbers::pi_v<float> ? 1 : 0,
            .port_x = static_cast<float>(-std::sin(port)),
            .port_y = static_cast<float>(std::cos(port)),
            .starboard_x = static_cast<float>(std::sin(starboard)),
            .starboard_y = static_cast<float>(-std::cos(starboard))};
  const int buckets = std::max(1, beam_count() * buckets_per_beam);
  buckets_per_rad_ = static_cast<float>(buckets / width);
  int beam = 0;
  for (int i = 0; i < buckets; ++i) {
    const double from = port - width * i / buckets;
    const double to = port - width * (i + 1) / buckets;
    while (beam + 1 < beam_count() && edge_rad(beam + 1) >= from) {
      ++beam;
    }
    int last = beam;
    while (last + 1 < beam_count() && edge_rad(last + 1) > to) {
      ++last;
    }
    first_beam_.push_back(static_cast<std::uint16_t>(beam));
    last_beam_.push_back(static_cast<std::uint16_t>(last));
  }
}

bool Fan::is_behind(const glm::vec3& centre_m, float radius_m) const {
  constexpr float slack = 1e-3F;  // as in misses_fan()
  const float horizontal_m = std::sqrt(centre_m.x * centre_m.x + centre_m.y * centre_m.y);
  const auto along_m = [&](double edge_rad) {
    return centre_m.x * static_cast<float>(std::cos(edge_rad)) +
           centre_m.y * static_cast<float>(std::sin(edge_rad));
  };
  return space_.is_convex != 0 && along_m(edges_rad_.front()) < 0 && along_m(edges_rad_.back()) < 0 &&
         horizontal_m * (1 - slack) > radius_m;
}

Fan::BeamRange Fan::beams_between(float low_rad, float high_rad) const {
  const auto port = static_cast<float>(edges_rad_.front());
  const auto last_bucket = static_cast<float>(first_beam_.size() - 1);
  const float from = (port - high_rad - azimuth_error_rad) * buckets_per_rad_;
  const float to = (port - low_rad + azimuth_error_rad) * buckets_per_rad_;
  if (!(to >= 0) || !(from <= last_bucket + 1)) {
    return {};
  }
  return {first_beam_[static_cast<std::size_t>(std::clamp(from, 0.0F, last_bucket))],
          last_beam_[static_cast<std::size_t>(std::clamp(to, 0.0F, last_bucket))]};
}

}  // namespace sonard::render
