#include "renderer/visibility/slices/fan.hpp"

#include <algorithm>
#include <cmath>

namespace sonard::render {

namespace {
constexpr int buckets_per_beam = 16;
}

Fan::Fan(const Aperture& aperture, double max_range_m)
    : edges_rad_(aperture.beam_edges_rad),
      elevation_limit_rad_(static_cast<float>(aperture.elevation_limit_rad())),
      tan_limit_(static_cast<float>(std::tan(aperture.elevation_limit_rad()))),
      max_range_m_(static_cast<float>(max_range_m)) {
  const double port = edges_rad_.front();
  const double width = port - edges_rad_.back();
  centre_rad_ = static_cast<float>(port - width / 2);
  half_width_rad_ = static_cast<float>(width / 2);
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
