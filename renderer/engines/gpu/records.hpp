// SPDX-License-Identifier: Apache-2.0
// The records that the CPU and the shaders share. In the layouts std140 and std430, numbers of four bytes lie
// one behind the other, and structures and arrays of a uniform block begin at multiples of 16 bytes.
#pragma once

#include <cstdint>

#include "renderer/engines/slices/slice_math.hpp"

#define CONSTANT inline constexpr
#define INTS_BY_FOUR(name, count) alignas(16) std::int32_t name[count]
#define FLOATS_BY_FOUR(name, count) alignas(16) float name[count]

namespace sonard::render::records {

using slices::Corner;
using slices::DivisionLimits;
using slices::FanSpace;
using slices::Placement;
using slices::side_probes;
using uint = std::uint32_t;

#include "renderer/engines/gpu/records.glsl"

}  // namespace sonard::render::records

#undef FLOATS_BY_FOUR
#undef INTS_BY_FOUR
#undef CONSTANT
