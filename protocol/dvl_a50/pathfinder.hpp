// SPDX-License-Identifier: Apache-2.0
// PD6 and PD4, the formats of an older make of DVL (7).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/dvl_a50/messages.hpp"
#include "protocol/dvl_a50/release.hpp"

namespace sonard::dvl_a50 {

/// Ten lines, each with CR LF.
std::string encode_pd6(const Velocity& report, double sound_speed_mps, Release release);

/// PD4. A bad velocity is -32768.
struct Pd4 {
  std::uint8_t id = 0x7D, structure = 0;
  std::uint16_t size = 45;                      ///< without the checksum
  std::uint8_t system = 0xA3;                   ///< ship coordinates, tilt used, 600 kHz
  std::array<std::int16_t, 4> velocity_mmps{};  ///< x, y, z, error
  std::array<std::uint16_t, 4> range_cm{};      ///< along the beams of transducers 3, 1, 4, 2; 0: bad
  std::uint8_t bottom_status = 0;               ///< 0: good
  std::array<std::uint8_t, 4> clock{};          ///< hour, minute, second, hundredths
  std::uint16_t sound_speed_mps = 0;
  std::uint16_t checksum = 0;  ///< sum of all bytes before it
};
/// 47 bytes, by layout.hpp.
std::vector<std::uint8_t> encode_pd4(const Velocity& report, double sound_speed_mps);

}  // namespace sonard::dvl_a50
