// SPDX-License-Identifier: Apache-2.0
// Specifications of the Oculus models (protocol/oculus/README.md 8).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace sonard::oculus {

inline constexpr double least_range_m = 0.1;

/// One of the two frequencies of a head.
struct Mode {
  double frequency_hz = 0.0;
  double most_range_m = 0.0;
  double horizontal_deg = 0.0;  ///< aperture, covered by the beams
  double vertical_deg = 0.0;
  double resolution_deg = 0.0;  ///< in azimuth: -3 dB width of a beam at broadside
  double range_cell_m = 0.0;    ///< c / 2B of the chirp
};

struct Model {
  std::string_view name;
  std::uint16_t part_number = 0;
  std::array<Mode, 2> modes;  ///< low frequency, high frequency; both the same if the head has one

  bool has_high_frequency() const { return modes[0].frequency_hz != modes[1].frequency_hz; }
  /// Index of the mode for a fire's master mode: 1 is low, all other values are high if the head has it.
  std::size_t mode_index(std::uint8_t master_mode) const {
    return master_mode == 1 || !has_high_frequency() ? 0 : 1;
  }
  const Mode& mode(std::uint8_t master_mode) const { return modes[mode_index(master_mode)]; }
};

// Section 8 says which of these values are assumptions.
inline constexpr Model m750d{
    "m750d", 1032, {Mode{750e3, 120.0, 130.0, 20.0, 1.0, 4e-3}, Mode{1.2e6, 40.0, 70.0, 20.0, 0.6, 2.5e-3}}};
inline constexpr Model m1200d{
    "m1200d",
    1042,
    {Mode{1.2e6, 40.0, 130.0, 20.0, 0.6, 2.5e-3}, Mode{2098880.597, 10.0, 60.0, 12.0, 0.4, 2.5e-3}}};
inline constexpr Model m3000d{
    "m3000d", 2203, {Mode{1.2e6, 30.0, 130.0, 20.0, 0.6, 2.5e-3}, Mode{3e6, 5.0, 40.0, 12.0, 0.4, 2.5e-3}}};
inline constexpr Mode m370s_mode{375e3, 200.0, 130.0, 20.0, 2.0, 8e-3};
inline constexpr Model m370s{"m370s", 1041, {m370s_mode, m370s_mode}};
inline constexpr Model c550d{
    "c550d",
    4713,
    {Mode{550e3, 100.0, 130.0, 20.0, 1.4, 5.5e-3}, Mode{820e3, 30.0, 70.0, 20.0, 0.9, 3.7e-3}}};

/// All models; the first one is the default.
inline constexpr std::array models{m750d, m1200d, m3000d, m370s, c550d};

}  // namespace sonard::oculus
