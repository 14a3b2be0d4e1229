// SPDX-License-Identifier: Apache-2.0
// The fan of a sonar: beams, their patterns and the receive array. All angles in radians.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace sonard::render {

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

}  // namespace sonard::render
