// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace sonard {

inline constexpr double degree = std::numbers::pi / 180;  ///< in radians

}  // namespace sonard
