// SPDX-License-Identifier: Apache-2.0
// The fan of a sonar, for slices: beams by azimuth, limits of elevation and range.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "renderer/aperture.hpp"
#include "renderer/engines/slices/slice_math.hpp"

namespace sonard::render {

using slices::azimuth_error_rad;
using slices::fast_azimuth;

/// The fan of one ping.
class Fan {
 public:
  static constexpr float widest_slice = 0.0174533F;  ///< radians, a degree

  Fan(const Aperture& aperture, double sampled_range_m);

  int beam_count() const { return static_cast<int>(edges_rad_.size()) - 1; }
  double edge_rad(int i) const { return edges_rad_[static_cast<std::size_t>(i)]; }
  float sampled_range_m() const { return space_.sampled_range_m; }
  float tan_limit() const { return tan_limit_; }
  const slices::FanSpace& space() const { return space_; }
  /// See slices::misses_fan().
  bool misses(const glm::vec3& centre_m, float radius_m) const {
    return slices::misses_fan(space_, {centre_m.x, centre_m.y, centre_m.z}, radius_m);
  }
  /// True if a sphere lies behind both sides of a fan of less than half a turn: its nearest point of the fan
  /// is the sonar. For large spheres; misses() may be false for them.
  bool is_behind(const glm::vec3& centre_m, float radius_m) const;

  /// An edge whose azimuth changes by less than this, at most a tenth of a beam, is upright: it runs along
  /// slices, and a cut does not show how much of the wedge lies to either side of it.
  float upright_rad() const { return std::min(1e-3F, 0.1F * width_rad_ / static_cast<float>(beam_count())); }

  /// Width of the widest slice.
  float widest_slice_rad() const {
    return std::min(widest_slice, width_rad_ / static_cast<float>(beam_count()));
  }

  /// Beams that azimuths [low, high] within (-pi, pi] may touch, possibly with a few more at either end; no
  /// beam if first > last.
  struct BeamRange {
    int first = 0;
    int last = -1;
  };
  BeamRange beams_between(float low_rad, float high_rad) const;

 private:
  std::vector<double> edges_rad_;
  float tan_limit_;
  float width_rad_;
  slices::FanSpace space_;
  float buckets_per_rad_;
  std::vector<std::uint16_t> first_beam_, last_beam_;  ///< per bucket of azimuth, from port to starboard
};

}  // namespace sonard::render
