// SPDX-License-Identifier: Apache-2.0
// The integrand of the oracle: the echo of a surface seen from the origin of the sonar frame, per steradian.
// docs/physics.md 2.1 equation (1), 2.4 Lambert and facets, 2.5 elevation pattern, 1.1 mode `paper`. Written
// from the formulas: it shares no code with the renderer, only its plain data types.
#pragma once

#include <vector>

#include "renderer/sonar_settings.hpp"

namespace sonard::oracle {

/// Acoustic properties of a surface; see render::AcousticMaterial.
struct Material {
  double lambert_mu = 1.0;
  double reflectance = 1.0;
  double pressure_reflection = 0.0;  ///< 0: no facets
  double rms_slope = 0.2;
};

/// The integrand of one ping. Spreading and absorption depend on the range of each point, not on the centre
/// of its range line. Within a line they differ by up to (2 / r + 0.46 alpha) * step / 2, relative. In a
/// partly filled line this difference shows in full, in an evenly filled one it cancels.
class EchoLaw {
 public:
  /// @throws std::invalid_argument if the settings have no beams, no lines or no elevation
  explicit EchoLaw(const render::SonarSettings& settings);

  /// Echo per steradian of a surface at `range_m`, seen at `cos_incidence` of either sign.
  double echo(const Material& material, double cos_incidence, double range_m, double sin_elevation) const;

  /// Relative weight of a direction. Mode `paper` divides by its integral over the range line.
  double pattern(double sin_elevation) const;

  /// Mode `paper`: the value of a line is the mean of its echo instead of the sum.
  bool is_mean() const { return mean_; }
  bool two_sided() const { return two_sided_; }

  const std::vector<double>& beam_edges_rad() const { return beam_edges_rad_; }
  int beams() const { return static_cast<int>(beam_edges_rad_.size()) - 1; }
  int lines() const { return lines_; }
  double step_m() const { return step_m_; }
  double max_range_m() const { return lines_ * step_m_; }
  double elevation_limit_rad() const { return elevation_limit_rad_; }

  /// A copy with spreading and absorption at the centre of each line, as in the renderer.
  EchoLaw with_loss_at_line_centre() const;

 private:
  double loss(double range_m) const;

  std::vector<double> beam_edges_rad_;
  int lines_;
  double step_m_;
  double elevation_limit_rad_;
  double pattern_scale_ = 0.0;  // 0: top hat
  bool two_way_ = false;
  double absorption_db_per_m_ = 0.0;
  bool mean_;
  bool facets_;
  bool two_sided_ = true;
  bool loss_at_line_centre_ = false;
  double sigmoid_slope_, sigmoid_centre_, attenuation_per_m_;
};

}  // namespace sonard::oracle
