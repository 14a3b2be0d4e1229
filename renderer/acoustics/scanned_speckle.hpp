// SPDX-License-Identifier: Apache-2.0
// The field under the speckle of a scanning head, kept from sweep to sweep.
#pragma once

#include <map>

#include "renderer/acoustics/complex_row.hpp"
#include "renderer/acoustics/pulse.hpp"
#include "renderer/acoustics/random.hpp"
#include "renderer/acoustics/speckle_field.hpp"
#include "renderer/pose.hpp"
#include "renderer/skip_ledger.hpp"

namespace sonard::render {

/// The direction of a single beam.
struct ScanPose {
  glm::dvec3 position_m;
  glm::dvec3 axis;     ///< that the head turns about: the sonar's z, in the world
  double bearing_rad;  ///< of the beam about this axis, from a direction that belongs to the world

  explicit ScanPose(const Pose& T_world_sonar);
};

/// CN(0, 1) per range bin, for one beam that is turned about the sonar's z axis. It sees what it saw a
/// sweep ago: the field belongs to bearings of the world, white over cells of half a
/// beamwidth, and a beam receives the cells around it. Two bearings apart by d are correlated by exp(-(d /
/// beamwidth)^2), as in recordings (docs/physics.md 2.16); only other motion than turning fades.
class ScannedSpeckle {
 public:
  ScannedSpeckle() = default;
  ScannedSpeckle(double beamwidth_rad, int lines);

  int lines() const { return lines_; }
  /// All bearings lose correlation: exp(-decay) of the field is left. @param decay >= 0
  void fade(double decay);
  /// The field at a bearing, correlated along the range by the pulse. @param key of the random numbers.
  /// @return valid until the next call.
  Phasors at(double bearing_rad, const PulseCorrelation& pulse, RandomKey key, const SkipSwitches& skip,
             SkipCounts& skipped);

 private:
  SpeckleField& cell_at(int number);

  double correlation_rad_ = 1.0;  ///< bearings this far apart are correlated by 1 / e
  int lines_ = 0;                 ///< with those beyond both ends that the pulse reaches
  int cell_count_ = 0;
  std::map<int, SpeckleField> cells_;  ///< those that were sampled: one row of all range bins each
  ComplexRow fresh_{0}, sum_{0}, out_{0};
};

}  // namespace sonard::render
