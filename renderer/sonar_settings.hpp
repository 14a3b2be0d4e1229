// SPDX-License-Identifier: Apache-2.0
// Settings of the renderer for one ping: aperture, range lines, water, receiver. All angles in radians.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace sonard::render {

/// Nearer surfaces are invisible; distance along the axis of the view.
inline constexpr float nearest_depth_m = 0.02F;

/// The fan of a sonar in its own frame (docs/frames-and-units.md).
struct Aperture {
  /// Edges of the beams: beam_count + 1 azimuths psi, strictly falling from port (psi > 0) to starboard,
  /// so beam 0 is the port-most. Inside (-pi, pi].
  std::vector<double> beam_edges_rad;
  /// -3 dB full width of the vertical beam, one-way, in (0, pi).
  double vertical_beamwidth_rad = 0.349065850398866;  // 20 degrees
  /// `top_hat`: weight 1 inside the beamwidth, 0 outside. `sinc`: one-way line-array pattern. `sinc_two_way`:
  /// its square, for an array that sends and receives with the same height (docs/physics.md 2.5). Both are
  /// rendered to 1.25 beamwidths on either side.
  enum class Elevation { top_hat, sinc, sinc_two_way } elevation = Elevation::top_hat;
  /// -3 dB width of one receive beam at broadside. It sets the correlation of speckle and noise across beams
  /// and, with Azimuth::array, the pattern of the beams.
  double receive_beamwidth_rad = 0.0174532925199433;  // 1 degree
  /// Amplitude weights of the receive array's elements (docs/physics.md 2.5). `kaiser`: with beta 2.5.
  enum class Taper { uniform, kaiser, hann, hamming } taper = Taper::hamming;
  /// Mode `physical`, two beams or more. `ideal`: a beam receives everything between its edges and nothing
  /// else. `array`: it receives with the pattern of a straight array steered to its middle, side lobes
  /// included; then the fan must lie within 90 degrees of the axis.
  enum class Azimuth { ideal, array } azimuth = Azimuth::ideal;
  /// With `array`: number of fine beams per beam, the resolution of bearings; 1 to 16.
  int fine_beams = 2;
  /// With `array`: `planar` bearings are azimuths. A straight array measures `conical` bearings, sin psi cos
  /// theta: objects off the horizontal plane appear nearer to the axis.
  enum class Bearing { planar, conical } bearing = Bearing::planar;
  /// With `array`: errors of the elements, drawn by seed and head. Standard deviations of the amplitude,
  /// relative and >= 0, and of the phase.
  double element_amplitude_sd = 0.0;
  double element_phase_sd_rad = 0.0;
  /// Seed of these errors; nullopt: PingRequest::seed. It keeps one array over many seeds of noise.
  std::optional<std::uint64_t> element_seed{};

  int beam_count() const { return beam_edges_rad.empty() ? 0 : static_cast<int>(beam_edges_rad.size()) - 1; }
  /// Half of the rendered range of elevations.
  double elevation_limit_rad() const;
  /// Power pattern at an elevation; 1 on the axis.
  double elevation_weight(double elevation_rad) const;
  /// Integral of the pattern over the sine of the rendered elevations: steradians per radian of azimuth.
  double pattern_height() const;

  bool operator==(const Aperture&) const = default;
};

/// @throws RequestError if there are no beams, if edges are not finite or not falling, if the fan is wider
/// than a full turn, if a beam lies across the backward azimuth, or if the elevations end too near the
/// vertical.
void check_aperture(const Aperture& aperture);

/// beam_count beams of equal angle over `width_rad`, centred on the acoustic axis.
std::vector<double> equal_angle_edges(int beam_count, double width_rad);
/// beam_count beams of equal sine over +-half_width_rad, as a multibeam sonar forms them.
std::vector<double> equal_sine_edges(int beam_count, double half_width_rad);

/// The range bins of a ping: bin i holds echoes from [i, i+1) * step_m. Output bins are averages (or peaks)
/// of 2^compression_log2 range bins. A remainder is dropped, as in the device.
struct RangeBins {
  int count = 1;             ///< range bins, >= 1
  double step_m = 0.01;      ///< > 0
  int compression_log2 = 0;  ///< 0..4
  bool compression_peak = false;

  double max_range_m() const { return count * step_m; }
  /// Range within which surfaces are rendered: a little beyond the last bin, so that footprints across it
  /// are complete.
  double sampled_range_m() const { return max_range_m() * 1.05; }
  int output_count() const { return count >> compression_log2; }

  bool operator==(const RangeBins&) const = default;
};

enum class Model {
  paper,     ///< Cerqueira et al. 2017: mean of sigmoid(rho cos phi), multiplicative speckle
  physical,  ///< sonar equation per solid angle, Rayleigh speckle, additive noise, TVG
};

/// Mode `paper`, with an interpretation for each point that the paper leaves open (docs/physics.md 1.2).
struct PaperModel {
  double sigmoid_slope = 18.0;        ///< A1
  double sigmoid_centre = 2.0 / 3.0;  ///< A1
  bool two_sided = true;              ///< A3; false: back faces are invisible
  bool legacy_bin_index = false;      ///< A4; floor(r / R_max (N - 1)) instead of floor(r / R_max N)
  bool legacy_columns = false;        ///< A7; assigns a whole column to the beam of its centre
  bool elevation_mask = true;         ///< false: the whole planar view counts, as in the paper
  bool footprint = true;              ///< false: a sample is a point in range
  double attenuation_per_m = 0.0;     ///< A10; a of exp(-2 a r), applied before the sigmoid
  double gain = 0.5;                  ///< A9; 0.5 is neutral, applied after speckle with a clamp at 1
  enum class Speckle { off, gaussian, folded_gaussian } speckle = Speckle::gaussian;  ///< A8
  double speckle_mean = 0.40;
  double speckle_sd = 0.15;
  double speckle_floor = 0.0;

  bool operator==(const PaperModel&) const = default;

  /// The authors' later public releases: folded N(0.95, 0.30) with floor 0.03, and attenuation. The
  /// attenuation here is cool sea water at 720 kHz (0.2085 dB/m as a factor of amplitude).
  static PaperModel release_2018() {
    PaperModel model;
    model.attenuation_per_m = 0.024;
    model.speckle = Speckle::folded_gaussian;
    model.speckle_mean = 0.95;
    model.speckle_sd = 0.30;
    model.speckle_floor = 0.03;
    return model;
  }
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

/// The pulse and the range bins for which levels are stated. A tone of another length has more or less energy
/// (docs/physics.md 2.6).
struct UsualPulse {
  double cell_m = 0.0;  ///< its PhysicalModel::range_cell_m; 0: levels do not depend on pulse length
  double step_m = 0.0;  ///< RangeBins::step_m of these bins; > 0 if cell_m > 0

  bool operator==(const UsualPulse&) const = default;
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

/// Small objects that drift in the water: fish, weed, bubbles (docs/physics.md 2.16).
struct WaterClutter {
  double density_per_m3 = 0.0;        ///< 0: none
  double target_strength_db = -45.0;  ///< of the mean intensity of one object, re 1 m

  bool operator==(const WaterClutter&) const = default;
};

/// Echoes by way of smooth surfaces, in mode `physical` (docs/physics.md 2.11). If nothing in range is smooth
/// enough, SkipRule::multipath skips them.
struct MultipathSettings {
  enum class Level {
    off,      ///< nothing
    surface,  ///< ghosts in the water surface (World::water_surface_z_m)
    full,     ///< ghosts in every surface that mirrors, corner reflectors, bounces
  } level = Level::full;
  double bounce_loss_db = 3.0;      ///< per reflection, in addition to R and mu; >= 0
  int most_bounces = 0;             ///< surfaces on a path; below 2: no paths between rough surfaces
  double wavelength_m = 0.0020833;  ///< at the middle of the band; > 0
  /// Rms height of the water surface: 0 is a mirror, a light breeze about 0.02. In wind the surface gives no
  /// image.
  double water_surface_rms_height_m = 0.02;

  bool operator==(const MultipathSettings&) const = default;
};

/// Mode `physical`: water, source and receiver (docs/physics.md 2.1-2.9, 2.16). Levels are intensities in dB.
struct PhysicalModel {
  double absorption_db_per_m = 0.2085;  ///< one way
  /// `lambert_facet`: surfaces reflect from their facets near normal incidence, if their material has facets.
  /// `lambert`: all are plain Lambert surfaces (docs/physics.md 2.4).
  enum class Backscatter { lambert, lambert_facet } backscatter = Backscatter::lambert_facet;
  enum class Speckle { off, frozen, per_ping, ou } speckle = Speckle::ou;
  double aperture_m = 0.1;  ///< array length; sets how far the sonar moves before speckle changes (`ou`)
  /// Response of the pulse in range, as intensity (docs/physics.md 2.6). `chirp`: matched filter, sinc^2.
  /// `windowed_chirp`: matched filter with a Hann window over the band. `tone`: a box. `point`: no length.
  enum class Pulse { point, chirp, windowed_chirp, tone } pulse = Pulse::point;
  /// Length of the pulse in range: c / 2B of a chirp of bandwidth B, c tau / 2 of a tone of duration tau.
  double range_cell_m = 0.0;
  /// c / 2B of the transducer's two-way band B, which rounds the ends of a tone; 0: sharp ends.
  double tone_rounding_m = 0.0;
  UsualPulse usual_pulse;
  /// Two-way loss of this pulse's echoes in the transducer's band; <= 0.
  double band_loss_db = 0.0;
  bool noise = true;
  /// Noise re the source intensity at 1 m, before TVG: NL - DI + 10 log10 B - SL.
  double noise_level_db = -138.2;  ///< render::noise_level_db() derives it from a sonar equation
  /// Noise added after TVG and gain, re full scale like gain_db; -infinity: no such noise.
  double output_noise_db = -std::numeric_limits<double>::infinity();
  /// c / 2B of the receiver's band B, with white noise in the band. 0: noise has the band of the pulse, as
  /// after a matched filter, so longer tones have less noise (docs/physics.md 2.9).
  double noise_cell_m = 0.0;
  /// Effective number of scatterers in a cell at `texture_range_m`, nu of the K distribution; proportional to
  /// range (docs/physics.md 2.8). 0: no texture.
  double texture_nu = 0.0;
  double texture_range_m = 10.0;  ///< > 0
  /// With OutputScale::half_decibels and one beam: weight of the two adjacent halves of the neighbouring bins
  /// in a bin's mean of decibels, [0, 1]; 0: a bin is the mean of its own cells.
  double bin_overlap = 0.0;
  /// Scattering strength of the water's volume, dB/m^3 (docs/physics.md 2.10); -infinity: no scattering.
  double volume_scattering_db = -std::numeric_limits<double>::infinity();
  WaterClutter water_clutter;
  double tvg_log_coefficient = 30.0;        ///< X of X log10 r + 2 alpha r
  double tvg_absorption_db_per_m = 0.2085;  ///< one way; the absorption that the device assumes
  double tvg_max_db = 62.0;                 ///< upper limit of the two terms together
  /// Output level of unit intensity after TVG, re full scale; the device's gain setting is added. Full scale
  /// of OutputScale::half_decibels is 80 dB.
  double gain_db = 60.0;
  MultipathSettings multipath;
  // Effects found in recordings of multibeam sonars (docs/physics.md 2.16).
  double near_field_blank_m = 0.7;  ///< at nearer ranges the output is exactly 0; 0 = off
  // Scanning sonars: level differences of noise between bearings, the same in each sweep, and the standard
  // deviation of the beam's direction, which differs between sweeps.
  double noise_by_bearing_db = 0.0;
  double bearing_jitter_rad = 0.0;
  double broadside_stripe_db = 3.5;  ///< extra noise two acoustic beams wide in mid-fan; 0 = off
  RingDown ring_down;
  Interference interference;
  /// Whether receive beams turn with the sonar while echoes return (docs/physics.md 2.14). false: the whole
  /// ping is received at the transmit pose.
  bool motion_within_ping = true;

  bool operator==(const PhysicalModel&) const = default;
};

/// Accuracy of sampling: a target error (docs/accuracy.md), pooled RMS over all bins above 1e-2 of their
/// beam's maximum, or a fixed grid of samples.
struct Sampling {
  enum class Preset {
    fast,       ///< 5 %
    normal,     ///< 1 %
    reference,  ///< the smallest possible error, for offline use
    grid,       ///< the grid below, regardless of the error
  } preset = Preset::normal;
  // Only with `grid`:
  int views = 3;  ///< side-by-side frusta; more are used if one would exceed 60 degrees
  int columns_per_view = 256;
  int rows = 512;
  /// false: a sample is a point in range, as in a renderer without footprints; for comparison
  /// (docs/benchmark.md).
  bool footprint = true;
  /// For masks, which must end where their bodies end. Engine `cpu`, not with `grid`: the echo of a facet (a
  /// triangle) lies between its nearest and its furthest range in each slice. Otherwise its ends follow
  /// straight lines across the slice, which may lead beyond its corners, and neighbouring facets make up for
  /// that.
  bool within_facets = false;

  static Sampling of_grid(int views, int columns_per_view, int rows) {
    return {Preset::grid, views, columns_per_view, rows, true, false};
  }
  bool operator==(const Sampling&) const = default;
};

/// How the code of a sample depends on the amplitude at the output.
enum class OutputScale {
  linear,         ///< proportional, full scale at the highest code
  power,          ///< proportional to its power `output_exponent`, rounded down: below the highest code
  half_decibels,  ///< for scanning sonars: 255 codes for 80 dB in half-decibel steps, at most 191
};

struct SonarSettings {
  Aperture aperture;
  RangeBins range;
  Model model = Model::physical;
  PaperModel paper;
  PhysicalModel physical;
  Sampling sampling;
  bool transmit = true;      ///< false: the sonar only listens, without echoes
  bool sixteen_bit = false;  ///< 16-bit instead of 8-bit output samples; not with half decibels
  OutputScale output_scale = OutputScale::linear;
  double output_exponent = 1.0;  ///< with OutputScale::power; > 0
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
