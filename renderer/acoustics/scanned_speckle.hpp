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
  glm::dvec3 axis;     ///< rotation axis of the head: the sonar's z, in the world frame
  double bearing_rad;  ///< of the beam about this axis, from a direction that is fixed in the world

  explicit ScanPose(const Pose& T_world_sonar);
};

/// CN(0, 1) per range bin, for one beam that turns about the sonar's z axis. Each sweep gets the speckle of
/// the last one, because the field belongs to bearings in the world: white over cells of half a beamwidth, of
/// which a beam receives the cells around it. Two bearings that differ by d are correlated by
/// exp(-(d / beamwidth)^2), as in recordings (docs/physics.md 2.16). Only motion other than turning fades it.
class ScannedSpeckle {
 public:
  ScannedSpeckle() = default;
  ScannedSpeckle(double beamwidth_rad, int lines);

  int lines() const { return lines_; }
  /// All bearings lose correlation: exp(-decay) of the field is left. @param decay >= 0
  void fade(double decay);
  /// The field at a bearing, correlated along the range by the pulse; valid until the next call. @param key
  /// of the random numbers
  Phasors at(double bearing_rad, const PulseCorrelation& pulse, RandomKey key, const SkipSwitches& skip,
             SkipCounts& skipped);

 private:
  SpeckleField& cell_at(int number);

  double correlation_rad_ = 1.0;  ///< bearings this far apart are correlated by 1 / e
  int lines_ = 0;                 ///< including the lines beyond both ends that the pulse reaches
  int cell_count_ = 0;
  std::map<int, SpeckleField> cells_;  ///< cells sampled so far: one row of all range bins each
  ComplexRow fresh_{0}, sum_{0}, out_{0};
};

}  // namespace sonard::render
