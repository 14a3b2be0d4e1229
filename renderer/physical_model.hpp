// SPDX-License-Identifier: Apache-2.0
// Settings of mode `physical`: water, source and receiver.
#pragma once

#include <limits>

#include "renderer/multipath_settings.hpp"

namespace sonard::render {

/// The pulse and the range bins for which levels are stated. A tone of another length has more or less energy
/// (docs/physics.md 2.6).
struct UsualPulse {
  double cell_m = 0.0;  ///< its PulseSettings::range_cell_m; 0: levels do not depend on pulse length
  double step_m = 0.0;  ///< RangeBins::step_m of these bins; > 0 if cell_m > 0

  bool operator==(const UsualPulse&) const = default;
};

/// Response of the pulse in range, as intensity (docs/physics.md 2.6).
struct PulseSettings {
  /// `chirp`: matched filter, sinc^2. `windowed_chirp`: matched filter with a Hann window over the band.
  /// `tone`: a box. `point`: no length.
  enum class Shape { point, chirp, windowed_chirp, tone } shape = Shape::point;
  /// Length of the pulse in range: c / 2B of a chirp of bandwidth B, c tau / 2 of a tone of duration tau.
  double range_cell_m = 0.0;
  /// c / 2B of the transducer's two-way band B, which rounds the ends of a tone; 0: sharp ends.
  double tone_rounding_m = 0.0;
  UsualPulse usual;
  /// Two-way loss of this pulse's echoes in the transducer's band; <= 0.
  double band_loss_db = 0.0;

  bool operator==(const PulseSettings&) const = default;
};

/// Small objects that drift in the water: fish, weed, bubbles (docs/physics.md 2.16).
struct WaterClutter {
  double density_per_m3 = 0.0;        ///< 0: none
  double target_strength_db = -45.0;  ///< of the mean intensity of one object, re 1 m

  bool operator==(const WaterClutter&) const = default;
};

/// Random levels of the echoes (docs/physics.md 2.8).
struct SpeckleSettings {
  enum class Kind { off, frozen, per_ping, ou } kind = Kind::ou;
  double aperture_m = 0.1;  ///< array length; sets how far the sonar moves before speckle changes (`ou`)
  /// Effective number of scatterers in a cell at `texture_range_m`, nu of the K distribution; proportional to
  /// range. 0: no texture.
  double texture_nu = 0.0;
  double texture_range_m = 10.0;  ///< > 0

  bool operator==(const SpeckleSettings&) const = default;
};

/// Bursts of noise from another sonar or the vehicle (docs/physics.md 2.16).
struct Interference {
  double probability = 0.0;             ///< that a ping has a burst, [0, 1]
  double least_db = 2.0;                ///< smallest rise of the noise
  double most_db = 11.0;                ///< largest rise; >= least_db
  double median_length_m = 4.0;         ///< half of the bursts are shorter, the longest have twice this; > 0
  double to_the_end_probability = 0.1;  ///< that a burst lasts to the end of the ping instead, [0, 1]

  bool operator==(const Interference&) const = default;
};

/// Noise of the receiver (docs/physics.md 2.9, 2.16).
struct NoiseSettings {
  bool on = true;
  /// Re the source intensity at 1 m, before TVG: NL - DI + 10 log10 B - SL.
  double level_db = -138.2;  ///< render::noise_level_db() derives it from a sonar equation
  /// Noise added after TVG and gain, re full scale like PhysicalModel::gain_db; -infinity: no such noise.
  double output_db = -std::numeric_limits<double>::infinity();
  /// c / 2B of the receiver's band B, with white noise in the band. 0: noise has the band of the pulse, as
  /// after a matched filter, so longer tones have less noise.
  double cell_m = 0.0;
  /// Scanning sonars: level differences between bearings, the same in each sweep.
  double by_bearing_db = 0.0;
  double broadside_stripe_db = 3.5;  ///< extra noise two acoustic beams wide in mid-fan; 0 = off
  Interference interference;

  bool operator==(const NoiseSettings&) const = default;
};

/// Time-varying gain (docs/physics.md 2.7).
struct TvgSettings {
  double log_coefficient = 30.0;        ///< X of X log10 r + 2 alpha r
  double absorption_db_per_m = 0.2085;  ///< one way; the absorption that the device assumes
  double max_db = 62.0;                 ///< upper limit of the two terms together

  bool operator==(const TvgSettings&) const = default;
};

/// Ringing of a scanning sonar's own transducer after the pulse (docs/physics.md 2.16).
struct RingDown {
  bool on = false;
  double level_db = 6.0;  ///< intensity at the peak, re the source intensity at 1 m, before TVG
  double peak_m = 0.28;   ///< > 0; the level rises from 0 at half of this range
  double end_m = 0.95;    ///< range at which it has fallen by 80 dB, > peak_m
  double sd_db = 2.0;     ///< standard deviation of its level from ping to ping, >= 0
  /// Echo of the vehicle around the sonar: intensity at 1 m, re the source intensity at 1 m, before TVG;
  /// -infinity: no echo.
  double vehicle_level_db = -std::numeric_limits<double>::infinity();
  double vehicle_fall_db_per_m = 14.0;  ///< decay of the vehicle's echo; > 0
  /// True: the pulse overdrives the receiver, whose output starts at the peak in the first sample. The
  /// ring-down then has no rise.
  bool from_start = false;

  bool operator==(const RingDown&) const = default;
};

/// Mode `physical`: water, source and receiver (docs/physics.md 2.1-2.9, 2.16). Levels are intensities in dB.
struct PhysicalModel {
  double absorption_db_per_m = 0.2085;  ///< one way
  /// `lambert_facet`: surfaces reflect from their facets near normal incidence, if their material has facets.
  /// `lambert`: all are plain Lambert surfaces (docs/physics.md 2.4).
  enum class Backscatter { lambert, lambert_facet } backscatter = Backscatter::lambert_facet;
  PulseSettings pulse;
  /// Scattering strength of the water's volume, dB/m^3 (docs/physics.md 2.10); -infinity: no scattering.
  double volume_scattering_db = -std::numeric_limits<double>::infinity();
  WaterClutter water_clutter;
  MultipathSettings multipath;
  SpeckleSettings speckle;
  NoiseSettings noise;
  TvgSettings tvg;
  /// Output level of unit intensity after TVG, re full scale; the device's gain setting is added. Full scale
  /// of OutputScale::half_decibels is 80 dB.
  double gain_db = 60.0;
  /// With OutputScale::half_decibels and one beam: weight of the two adjacent halves of the neighbouring bins
  /// in a bin's mean of decibels, [0, 1]; 0: a bin is the mean of its own cells.
  double bin_overlap = 0.0;
  // Effects found in recordings (docs/physics.md 2.16).
  double near_field_blank_m = 0.7;  ///< at nearer ranges the output is exactly 0; 0 = off
  /// Scanning sonars: standard deviation of the beam's direction, which differs between sweeps.
  double bearing_jitter_rad = 0.0;
  RingDown ring_down;
  /// Whether receive beams turn with the sonar while echoes return (docs/physics.md 2.14). false: the whole
  /// ping is received at the transmit pose.
  bool motion_within_ping = true;

  bool operator==(const PhysicalModel&) const = default;
};

}  // namespace sonard::render
