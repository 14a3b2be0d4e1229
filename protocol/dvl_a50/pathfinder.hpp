// SPDX-License-Identifier: Apache-2.0
// PD6 and PD4, the formats of an older make of DVL (7).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/dvl_a50/messages.hpp"
#include "protocol/dvl_a50/release.hpp"

namespace sonard::dvl_a50 {

/// Ten lines, each with CR LF.
std::string encode_pd6(const Velocity& report, double sound_speed_mps, Release release);
/// 47 bytes.
std::vector<std::uint8_t> encode_pd4(const Velocity& report, double sound_speed_mps);

}  // namespace sonard::dvl_a50
