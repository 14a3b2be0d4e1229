// SPDX-License-Identifier: Apache-2.0
// Settings of the renderer for one ping, joined from their parts. Include the parts that you use.
#pragma once

#include "renderer/aperture.hpp"
#include "renderer/direction_grid.hpp"
#include "renderer/model.hpp"
#include "renderer/paper_model.hpp"
#include "renderer/physical_model.hpp"
#include "renderer/range_bins.hpp"
#include "renderer/sampling.hpp"

namespace sonard::render {

/// How the code of a sample depends on the amplitude at the output.
enum class OutputScale {
  linear,         ///< proportional, full scale at the highest code
  power,          ///< proportional to its power `output_exponent`, rounded down: below the highest code
  half_decibels,  ///< for scanning sonars: 255 codes for 80 dB in half-decibel steps, at most 191
};

struct SonarSettings {
  Aperture aperture;
  /// Directions, each with the range of its strongest echo; if set, the result has these instead of an image.
  /// `aperture` is then direction_aperture(), and two range bins are as long as the range resolution.
  DirectionGrid directions;
  RangeBins range;
  Model model = Model::physical;
  PaperModel paper;
  PhysicalModel physical;
  Sampling sampling;
  bool transmit = true;      ///< false: the sonar only listens, without echoes
  bool sixteen_bit = false;  ///< 16-bit instead of 8-bit output samples; not with half decibels
  OutputScale output_scale = OutputScale::linear;
  double output_exponent = 1.0;  ///< with OutputScale::power; > 0
  /// Amplitude at the highest code, > 0; not with half decibels. A receiver clips at 1, so a greater one
  /// shows what it clips.
  double output_full_scale = 1.0;
};

/// Whether the beams have patterns of a straight array: mode `physical`, Azimuth::array, two beams or more.
inline bool has_array_beams(const SonarSettings& settings) {
  return settings.model == Model::physical && settings.aperture.azimuth == Aperture::Azimuth::array &&
         settings.aperture.beam_count() > 1;
}

/// Whether the beams are cones around a straight array.
inline bool has_conical_beams(const SonarSettings& settings) {
  return has_array_beams(settings) && settings.aperture.bearing == Aperture::Bearing::conical;
}

}  // namespace sonard::render
