// SPDX-License-Identifier: Apache-2.0
// What slice_math.hpp gives C++, for GLSL 4.30.
#define SHARED
#define CONSTANT const
bool both(bool a, bool b) {
  return a && b;
}
float with_sign_of(float x, float sign) {
  return intBitsToFloat((floatBitsToInt(x) & 0x7fffffff) | (floatBitsToInt(sign) & ~0x7fffffff));
}
