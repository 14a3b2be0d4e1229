// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/water.hpp"

#include <cmath>

namespace sonard::render {
namespace {

/// Amplitude of one relaxation, f_r f^2 / (f_r^2 + f^2); 0 without the salt (f_r = 0), also at f = 0.
double relaxation(double relaxation_khz, double f_khz) {
  if (relaxation_khz <= 0.0) {
    return 0.0;
  }
  const double f2 = f_khz * f_khz;
  return relaxation_khz * f2 / (relaxation_khz * relaxation_khz + f2);
}

/// Francois & Garrison's A3, dB/km/kHz^2.
double pure_water_coefficient(double t) {
  if (t <= 20.0) {
    return 4.937e-4 + t * (-2.59e-5 + t * (9.11e-7 - t * 1.50e-8));
  }
  return 3.964e-4 + t * (-1.146e-5 + t * (1.45e-7 - t * 6.5e-10));
}

}  // namespace

double francois_garrison_absorption_db_per_m(double frequency_hz, const Water& water) {
  const double f = frequency_hz / 1000.0;
  const double t = water.temperature_c;
  const double s = water.salinity_ppt;
  const double d = water.depth_m;
  const double kelvin = 273.0 + t;
  const double c = 1412.0 + 3.21 * t + 1.19 * s + 0.0167 * d;

  const double boric_amplitude = 8.86 / c * std::pow(10.0, 0.78 * water.ph - 5.0);
  const double boric_khz = 2.8 * std::sqrt(s / 35.0) * std::pow(10.0, 4.0 - 1245.0 / kelvin);

  const double magnesium_amplitude = 21.44 * s / c * (1.0 + 0.025 * t);
  const double magnesium_pressure = 1.0 + d * (-1.37e-4 + 6.2e-9 * d);
  const double magnesium_khz = 8.17 * std::pow(10.0, 8.0 - 1990.0 / kelvin) / (1.0 + 0.0018 * (s - 35.0));

  const double water_pressure = 1.0 + d * (-3.83e-5 + 4.9e-10 * d);

  const double db_per_km = boric_amplitude * relaxation(boric_khz, f) +
                           magnesium_amplitude * magnesium_pressure * relaxation(magnesium_khz, f) +
                           pure_water_coefficient(t) * water_pressure * f * f;
  return db_per_km / 1000.0;
}

bool in_absorption_range(double frequency_hz, const Water& water) {
  return frequency_hz >= 200.0 && frequency_hz <= 1.0e6 && water.temperature_c >= -2.0 &&
         water.temperature_c <= 30.0 && water.salinity_ppt >= 30.0 && water.salinity_ppt <= 35.0;
}

double mackenzie_sound_speed_mps(const Water& water) {
  const double t = water.temperature_c;
  const double s = water.salinity_ppt - 35.0;
  const double d = water.depth_m;
  return 1448.96 + t * (4.591 + t * (-5.304e-2 + t * 2.374e-4)) + 1.340 * s + d * (1.630e-2 + d * 1.675e-7) -
         1.025e-2 * t * s - 7.139e-13 * t * d * d * d;
}

double medwin_sound_speed_mps(const Water& water) {
  const double t = water.temperature_c;
  return 1449.2 + t * (4.6 + t * (-0.055 + t * 0.00029)) + (1.34 - 0.010 * t) * (water.salinity_ppt - 35.0) +
         0.016 * water.depth_m;
}

double sound_speed_mps(const Water& water) {
  const bool in_mackenzie_range = water.temperature_c >= 2.0 && water.temperature_c <= 30.0 &&
                                  water.salinity_ppt >= 25.0 && water.salinity_ppt <= 40.0;
  return in_mackenzie_range ? mackenzie_sound_speed_mps(water) : medwin_sound_speed_mps(water);
}

}  // namespace sonard::render
