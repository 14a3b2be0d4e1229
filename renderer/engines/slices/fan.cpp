// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/slices/fan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sonard::render {

namespace {
constexpr int buckets_per_beam = 16;
}

Fan::Fan(const Aperture& aperture, double max_range_m)
    : edges_rad_(aperture.beam_edges_rad),
      sin_limit_(static_cast<float>(std::sin(aperture.elevation_limit_rad()))),
      cos_limit_(static_cast<float>(std::cos(aperture.elevation_limit_rad()))),
      tan_limit_(static_cast<float>(std::tan(aperture.elevation_limit_rad()))),
      max_range_m_(static_cast<float>(max_range_m)) {
  const double port = edges_rad_.front();
  const double width = port - edges_rad_.back();
  const double starboard = edges_rad_.back();
  width_rad_ = static_cast<float>(width);
  beyond_port_ = {-std::sin(port), std::cos(port)};
  beyond_starboard_ = {std::sin(starboard), -std::cos(starboard)};
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

bool Fan::misses(const glm::vec3& centre_m, float radius_m) const {
  constexpr float slack = 1e-3F;  // radians; more than all rounding errors here
  const float horizontal_m = std::sqrt(centre_m.x * centre_m.x + centre_m.y * centre_m.y);
  const float distance_m = std::sqrt(horizontal_m * horizontal_m + centre_m.z * centre_m.z);
  const float reach_m = radius_m + slack * distance_m;
  if (distance_m - radius_m > max_range_m_ ||
      std::abs(centre_m.z) * cos_limit_ - horizontal_m * sin_limit_ > reach_m) {
    return true;
  }
  const float port_m = centre_m.x * beyond_port_.x + centre_m.y * beyond_port_.y;
  const float starboard_m = centre_m.x * beyond_starboard_.x + centre_m.y * beyond_starboard_.y;
  // A sphere beyond either side is outside a fan of up to half a turn; beyond both sides, outside a wider
  // fan.
  const bool convex = width_rad_ < std::numbers::pi_v<float>;
  return (convex ? std::max(port_m, starboard_m) : std::min(port_m, starboard_m)) > reach_m;
}

bool Fan::is_behind(const glm::vec3& centre_m, float radius_m) const {
  constexpr float slack = 1e-3F;  // as in misses()
  const float horizontal_m = std::sqrt(centre_m.x * centre_m.x + centre_m.y * centre_m.y);
  const auto along_m = [&](double edge_rad) {
    return centre_m.x * static_cast<float>(std::cos(edge_rad)) +
           centre_m.y * static_cast<float>(std::sin(edge_rad));
  };
  return width_rad_ < std::numbers::pi_v<float> && along_m(edges_rad_.front()) < 0 &&
         along_m(edges_rad_.back()) < 0 && horizontal_m * (1 - slack) > radius_m;
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
