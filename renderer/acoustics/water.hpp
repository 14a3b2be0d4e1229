// SPDX-License-Identifier: Apache-2.0
// Absorption and speed of sound in sea and fresh water. Pure functions, thread-safe.
// Formulas, ranges and check values: docs/physics.md 2.2.
#pragma once

namespace sonard::render {

/// The water at one depth.
struct Water {
  double temperature_c = 10.0;
  double salinity_ppt = 35.0;  ///< >= 0; 0 is fresh water
  double depth_m = 10.0;       ///< >= 0
  double ph = 8.0;
};

/// One-way absorption after Francois & Garrison (1982). Finite for every finite input with frequency_hz >= 0;
/// accurate to 5-10 % if in_absorption_range() is true.
double francois_garrison_absorption_db_per_m(double frequency_hz, const Water& water);

/// True inside the stated range of the formula of Francois & Garrison: 0.2 kHz to 1 MHz, -2 to 30 degC,
/// 30 to 35 ppt. Outside, the formula extrapolates, and callers should warn.
bool in_absorption_range(double frequency_hz, const Water& water);

/// Speed of sound after Mackenzie (1981): 2 to 30 degC, 25 to 40 ppt, 0 to 8000 m.
double mackenzie_sound_speed_mps(const Water& water);

/// Speed of sound after Medwin (1975): 0 to 35 degC, 0 to 45 ppt, 0 to 1000 m.
double medwin_sound_speed_mps(const Water& water);

/// Mackenzie inside its range of temperature and salinity, Medwin outside.
double sound_speed_mps(const Water& water);

}  // namespace sonard::render
