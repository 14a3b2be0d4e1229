// SPDX-License-Identifier: Apache-2.0
// The arithmetic of azimuth slices, the same text for C++ and GLSL 4.30. The *.glsl files of this folder are
// in the common subset of both languages. This header gives C++ what GLSL has built in; language.glsl is its
// counterpart.
//
// Rules of the common subset:
// - Numbers are float, int and bool. No doubles, no 64-bit integers, no pointers, no references, no arrays.
// - Types are structs without member functions. Conversions are written int(x), float(x).
// - Constants begin with CONSTANT.
// - Functions begin with SHARED. They return results by value, so that loops around them can be vectorised.
// - Results that decide what is visible are `precise`: they are not fused into multiply-adds.
// - both() joins conditions in vectorised loops: GLSL has no & of bools, and GCC 12 does not vectorise &&.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#define SHARED [[gnu::always_inline]] inline
#define CONSTANT inline constexpr
#define precise

namespace sonard::render::slices {

using std::abs;
using std::ceil;
using std::floor;
using std::sqrt;

SHARED float min(float a, float b) {
  return b < a ? b : a;
}
SHARED float max(float a, float b) {
  return a < b ? b : a;
}
SHARED int floatBitsToInt(float x) {  // NOLINT(readability-identifier-naming): its name in GLSL
  return std::bit_cast<int>(x);
}
SHARED float intBitsToFloat(int bits) {  // NOLINT(readability-identifier-naming): as above
  return std::bit_cast<float>(bits);
}
SHARED bool both(bool a, bool b) {
  return a & b;
}
SHARED float cube_root(float x) {
  return std::cbrt(x);
}
SHARED float with_sign_of(float x, float sign) {
  return std::copysign(x, sign);
}

// In the order of a ping; a file may use those before it.
// clang-format off
#include "renderer/engines/slices/cut.glsl"
#include "renderer/engines/slices/place.glsl"
#include "renderer/engines/slices/sweep.glsl"
#include "renderer/engines/slices/sides.glsl"
#include "renderer/engines/slices/refine.glsl"
#include "renderer/engines/slices/patches.glsl"
#include "renderer/engines/slices/facets.glsl"
// clang-format on

}  // namespace sonard::render::slices

#undef precise
#undef CONSTANT
#undef SHARED
