// SPDX-License-Identifier: Apache-2.0
// Specifications of the Oculus models (docs/protocols/oculus.md 8).
#pragma once

#include <array>
#include <cstdint>

namespace sonard::oculus {

inline constexpr double least_range_m = 0.1;

/// One of the two frequencies of a head.
struct Mode {
  double frequency_hz = 0.0;
  double most_range_m = 0.0;
  double horizontal_deg = 0.0;  ///< aperture, covered by the beams
  double vertical_deg = 0.0;
};

struct Model {
  std::uint16_t part_number = 0;
  std::array<Mode, 2> modes;  ///< low frequency, high frequency

  /// The mode for a fire's master mode: 1 is low, all other values are high.
  const Mode& mode(std::uint8_t master_mode) const { return modes[master_mode == 1 ? 0 : 1]; }
};

/// The high-frequency aperture is an assumption.
inline constexpr Model m750d{1032, {Mode{750e3, 120.0, 130.0, 20.0}, Mode{1.2e6, 40.0, 70.0, 20.0}}};
inline constexpr Model m1200d{1042, {Mode{1.2e6, 40.0, 130.0, 20.0}, Mode{2098880.597, 10.0, 60.0, 12.0}}};

}  // namespace sonard::oculus
