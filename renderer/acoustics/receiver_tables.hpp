// SPDX-License-Identifier: Apache-2.0
// Tables that the receiver computes once for many pings.
#pragma once

#include <vector>

#include "renderer/acoustics/beam_correlation.hpp"
#include "renderer/acoustics/pulse.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// Tables of mode `physical` that depend on the settings alone; kept until these change.
struct ReceiverTables {
  Aperture aperture;
  RangeBins range;
  PhysicalModel model;
  bool sixteen_bit = false;
  OutputScale output_scale = OutputScale::linear;
  bool rings = false;  ///< there is a ring-down

  /// Range cells in a line of a single beam, each with its own speckle and noise; 1 for several beams.
  int cells = 1;
  float overlap = 0;  ///< weight of the cell before and of the cell behind the line
  BeamFilter filter;
  PulseCorrelation pulse_correlation;  ///< of speckle and texture, from cell to cell
  PulseCorrelation noise_correlation;
  std::vector<float> gain;       ///< per range bin: amplitude to codes, TVG included
  std::vector<float> profile;    ///< per beam: noise amplitude re beams away from broadside
  std::vector<float> noise;      ///< per range bin: amplitude before TVG; 0: off
  std::vector<float> ring_down;  ///< per range bin: amplitude before TVG
  int ring_down_bins = 0;
  std::vector<float> vehicle;  ///< per range bin: mean intensity of the vehicle's reverberation

  ReceiverTables() = default;
  explicit ReceiverTables(const SonarSettings& settings);
  /// True if made from these settings.
  bool fits(const SonarSettings& settings) const;
};

}  // namespace sonard::render
