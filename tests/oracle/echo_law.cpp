// SPDX-License-Identifier: Apache-2.0
#include "tests/oracle/echo_law.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace sonard::oracle {

EchoLaw::EchoLaw(const render::SonarSettings& settings)
    : beam_edges_rad_(settings.aperture.beam_edges_rad),
      lines_(settings.range.count),
      step_m_(settings.range.step_m),
      elevation_limit_rad_(settings.aperture.vertical_beamwidth_rad / 2),
      mean_(settings.model == render::Model::paper),
      facets_(settings.physical.backscatter == render::PhysicalModel::Backscatter::lambert_facet),
      sigmoid_slope_(settings.paper.sigmoid_slope),
      sigmoid_centre_(settings.paper.sigmoid_centre),
      attenuation_per_m_(settings.paper.attenuation_per_m) {
  if (settings.aperture.elevation != render::Aperture::Elevation::top_hat) {
    // The one-way power is one half at a sine of 0.443 times the first zero. The pattern extends to 1.25
    // times the
    // -3 dB full width on each side.
    pattern_scale_ = 0.443 * std::numbers::pi / std::sin(elevation_limit_rad_);
    elevation_limit_rad_ *= 2.5;
    two_way_ = settings.aperture.elevation == render::Aperture::Elevation::sinc_two_way;
  }
  if (mean_) {
    two_sided_ = settings.paper.two_sided;
  } else {
    absorption_db_per_m_ = settings.physical.absorption_db_per_m;
  }
  if (beam_edges_rad_.size() < 2 || lines_ < 1 || !(step_m_ > 0) || !(elevation_limit_rad_ > 0) ||
      !(elevation_limit_rad_ < std::numbers::pi / 2)) {
    throw std::invalid_argument("the oracle needs beams, range lines and an elevation below 90 degrees");
  }
}

double EchoLaw::pattern(double sin_elevation) const {
  const double x = pattern_scale_ * sin_elevation;
  if (std::abs(x) < 1e-8) {
    return 1.0;
  }
  const double amplitude = std::sin(x) / x;
  return std::pow(amplitude, two_way_ ? 4 : 2);
}

double EchoLaw::loss(double range_m) const {
  const double r = loss_at_line_centre_ ? (std::floor(range_m / step_m_) + 0.5) * step_m_ : range_m;
  const double spreading = 1.0 / (r * r);
  return absorption_db_per_m_ == 0 ? spreading : spreading * std::pow(10.0, -absorption_db_per_m_ * r / 5);
}

double EchoLaw::echo(const Material& material, double cos_incidence, double range_m,
                     double sin_elevation) const {
  const double cosine = std::min(std::abs(cos_incidence), 1.0);
  if (mean_) {
    const double intensity =
        std::min(1.0, material.reflectance * cosine * std::exp(-2 * attenuation_per_m_ * range_m));
    return pattern(sin_elevation) / (1 + std::exp(-sigmoid_slope_ * (intensity - sigmoid_centre_)));
  }
  // s_b / cos phi
  double response = material.lambert_mu * cosine;
  if (facets_ && material.pressure_reflection != 0 && cosine > 0) {
    const double m2 = material.rms_slope * material.rms_slope;
    response += std::pow(material.pressure_reflection, 2) /
                (8 * std::numbers::pi * m2 * std::pow(cosine, 5)) *
                std::exp(-(1 / (cosine * cosine) - 1) / (2 * m2));
  }
  return pattern(sin_elevation) * response * loss(range_m);
}

EchoLaw EchoLaw::with_loss_at_line_centre() const {
  EchoLaw law = *this;
  law.loss_at_line_centre_ = true;
  return law;
}

}  // namespace sonard::oracle
