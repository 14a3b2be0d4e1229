// SPDX-License-Identifier: Apache-2.0
// Whole numbers of 64 bits in two words, low word first, negative ones as complements. Every OpenGL 4.3 has
// them.

uvec2 plus(uvec2 a, uvec2 b) {
  uint carry;
  uint low = uaddCarry(a.x, b.x, carry);
  return uvec2(low, a.y + b.y + carry);
}
uvec2 negative(uvec2 a) {
  return plus(~a, uvec2(1u, 0u));
}
uvec2 minus(uvec2 a, uvec2 b) {
  return plus(a, negative(b));
}
uvec2 times(uvec2 a, int factor) {
  uint size = uint(abs(factor)), high, low;
  umulExtended(a.x, size, high, low);
  uvec2 product = uvec2(low, high + a.y * size);
  return factor < 0 ? negative(product) : product;
}

// The nearest whole number to x, which is below 2^63.
uvec2 whole_of(float x) {
  precise float size = abs(x) < 8388608.0 ? floor(abs(x) + 0.5) : abs(x);  // larger floats are whole
  precise float high = floor(size * (1.0 / 4294967296.0));
  precise float low = size - high * 4294967296.0;
  uvec2 whole = uvec2(uint(low), uint(high));
  return x < 0.0 ? negative(whole) : whole;
}
float float_of(uvec2 whole) {
  bool below_0 = whole.y >= 0x80000000u;
  uvec2 size = below_0 ? negative(whole) : whole;
  float x = float(size.y) * 4294967296.0 + float(size.x);
  return below_0 ? -x : x;
}
