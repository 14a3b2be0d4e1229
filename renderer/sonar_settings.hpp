// What one ping asks of the renderer: aperture, range lines, water, receiver. All angles in radians.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sonard::render {

/// The fan of a sonar in its own frame.
struct Aperture {
  /// Edges of the beams: beam_count + 1 azimuths psi, strictly falling from port (psi > 0) to starboard,
  /// so beam 0 is the port-most. Inside (-pi, pi].
  std::vector<double> beam_edges_rad;
  /// -3 dB full width of the vertical beam. The fan is cut at +-1/2 of it by `Elevation::top_hat` and at
  /// +-1.25/2 of it by `Elevation::sinc`.
  double vertical_beamwidth_rad = 0.349065850398866;  // 20 degrees
  enum class Elevation { top_hat, sinc } elevation = Elevation::top_hat;

  int beam_count() const { return static_cast<int>(beam_edges_rad.size()) - 1; }
  /// Half of the rendered elevation fan.
  double elevation_limit_rad() const;
};

/// beam_count beams of equal angle over `width_rad`, centred on the acoustic axis.
std::vector<double> equal_angle_edges(int beam_count, double width_rad);
/// beam_count beams of equal sine over +-half_width_rad, as a Gemini forms them.
std::vector<double> equal_sine_edges(int beam_count, double half_width_rad);

/// Native range lines: line i holds echoes from [i, i+1) * step_m. The output lines are averages (or peaks) of
/// 2^compression_log2 native lines.
struct RangeLines {
  int count = 1;               ///< native lines, >= 1
  double step_m = 0.01;        ///< > 0
  int compression_log2 = 0;    ///< 0..4
  bool compression_peak = false;

  double max_range_m() const { return count * step_m; }
  int output_count() const { return count >> compression_log2; }
};

enum class Model {
  paper,     ///< Cerqueira et al. 2017: mean of sigmoid(rho cos phi), multiplicative speckle
  physical,  ///< sonar equation per solid angle, Rayleigh speckle, additive noise, TVG
};

/// Mode `paper`: readings of the paper where it is silent.
struct PaperModel {
  double sigmoid_slope = 18.0;
  double sigmoid_centre = 2.0 / 3.0;
  double speckle_mean = 0.40;  ///< Gaussian, clamped at 0
  double speckle_sd = 0.15;
  bool legacy_bin_index = false;  ///< floor(r / R_max (N - 1)) instead of floor(r / R_max N)
  bool footprint = true;          ///< false: a sample is a point in range
};

/// Mode `physical`: water, source and receiver.
struct PhysicalModel {
  double absorption_db_per_m = 0.2085;  ///< one way
  enum class Speckle { off, frozen, per_ping, ou } speckle = Speckle::ou;
  bool noise = true;
  /// Noise intensity re the source level at 1 m, dB, before TVG: NL - DI + 10 log10 B - SL.
  double noise_level_db = -138.2;
  double tvg_log_coefficient = 30.0;      ///< X of X log10 r
  double tvg_absorption_db_per_m = 0.2085;  ///< one way, applied twice
  double tvg_max_db = 75.0;
  /// Output level of unit intensity after TVG, dB re full scale; a device's gain setting is added to it.
  double gain_db = 60.0;
  double near_field_blank_m = 0.0;   ///< output lines nearer than this are exactly 0
  double broadside_stripe_db = 0.0;  ///< extra noise in the middle of the fan, 0 = off
  double side_lobe_floor_db = 0.0;   ///< leakage along a range line, negative; 0 = off
  double aperture_m = 0.1;           ///< array length; sets how far speckle survives motion
};

/// How finely the world is sampled.
struct Sampling {
  int views = 3;              ///< side-by-side frusta; each spans at most 60 degrees
  int columns_per_view = 256;
  int rows = 512;
};

struct SonarSettings {
  Aperture aperture;
  RangeLines range;
  Model model = Model::physical;
  PaperModel paper;
  PhysicalModel physical;
  Sampling sampling;
  bool sixteen_bit = false;
};

}  // namespace sonard::render
