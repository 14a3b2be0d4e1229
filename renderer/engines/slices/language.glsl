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
// Of a number >= 1. The first guess, of a third of the exponent, is off by 4 %; Newton's rule squares that.
float cube_root(float x) {
  float root = intBitsToFloat(floatBitsToInt(x) / 3 + 709921077);
  for (int i = 0; i < 3; ++i) {
    root -= (root - x / (root * root)) * (1.0 / 3.0);
  }
  return root;
}
