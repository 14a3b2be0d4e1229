// SPDX-License-Identifier: Apache-2.0
// Specular reflection of sound by a surface (docs/physics.md 2.11).
#pragma once

#include <cmath>
#include <numbers>

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Least gain of a mirror, |R|^2 exp(-P^2); weaker surfaces do not count as mirrors: -15 dB.
inline constexpr double least_mirror_gain = 0.0316227766016838;

/// Coherent part of the reflected intensity, R^2 exp(-P^2) with P = 2 k sigma sin gamma (Rayleigh's roughness
/// parameter), and the sign of the pressure.
struct Mirror {
  double pressure_reflection = 0.0;  ///< R, in [-1, 1]
  double rms_height_m = 0.0;         ///< sigma, >= 0

  Mirror() = default;
  Mirror(double pressure_reflection_in, double rms_height_m_in)
      : pressure_reflection(pressure_reflection_in), rms_height_m(rms_height_m_in) {}
  explicit Mirror(const AcousticMaterial& material)
      : Mirror(material.pressure_reflection, material.rms_height_m) {}

  /// Factor of the intensity. @param sin_grazing sine of the grazing angle
  double gain(double sin_grazing, double wavelength_m) const {
    const double p = 4 * std::numbers::pi / wavelength_m * rms_height_m * sin_grazing;
    return pressure_reflection * pressure_reflection * std::exp(-p * p);
  }
  /// Factor of the pressure; its square is gain().
  double pressure(double sin_grazing, double wavelength_m) const {
    return std::copysign(std::sqrt(gain(sin_grazing, wavelength_m)), pressure_reflection);
  }
};

}  // namespace sonard::render
