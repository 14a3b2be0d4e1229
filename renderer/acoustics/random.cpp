// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/random.hpp"

#include <bit>
#include <cmath>
#include <numbers>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

/// SplitMix64 finaliser (Steele, Lea, Flood 2014).
std::uint64_t mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

/// -ln(u) for u in (0, 1], relative error below 2e-6: exponent and a minimax polynomial of the mantissa.
[[gnu::always_inline]] inline float minus_log(float u) {
  const auto bits = std::bit_cast<std::int32_t>(u);
  // Shift the mantissa range to [1/sqrt 2, sqrt 2), where the polynomial is shortest.
  const std::int32_t exponent = (bits - 0x3F3504F3) >> 23;
  const float m = std::bit_cast<float>(bits - (exponent << 23)) - 1.0F;
  // Pairs first: the length of the chain of operations limits the loop, not their number.
  const float m2 = m * m;
  const float low = (-1.0000010F + 0.50001113F * m) + m2 * (-0.33314509F + 0.24909744F * m);
  const float high = (-0.20496329F + 0.18667858F * m) - m2 * 0.11896110F;
  return m * (low + (m2 * m2) * high) - static_cast<float>(exponent) * 0.69314718F;
}

/// sin(2 pi t) for t in [-1/4, 1/4]: minimax polynomial, error below 1e-6.
[[gnu::always_inline]] inline float sine_quarter(float t) {
  const float t2 = t * t;
  return t * ((6.2831640F - t2 * 41.337142F) + (t2 * t2) * (81.340768F - t2 * 70.993428F));
}

}  // namespace

RandomKey make_random_key(std::uint64_t seed, int head, RandomField field, std::uint64_t ping_number) {
  std::uint64_t key = mix(seed);
  key = mix(key ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(head)));
  key = mix(key ^ static_cast<std::uint64_t>(field));
  return {mix(key ^ ping_number)};
}

double uniform_number(RandomKey key, std::uint64_t index) {
  return static_cast<double>(mix(key.value ^ index) >> 11) * 0x1p-53;
}

double normal_number(RandomKey key) {
  // Real and imaginary part of CN(0, 1) have the variance 1/2.
  float real = 0, imaginary = 0;
  fill_complex_gaussian(key, 0, 1, &real, &imaginary);
  return std::numbers::sqrt2 * static_cast<double>(real);
}

SONARD_SIMD_CLONES
void fill_complex_gaussian(RandomKey key, std::uint32_t row, int count, float* __restrict real,
                           float* __restrict imaginary) {
  // mix() is a bijection, so each row of a field has a different key.
  const std::uint64_t row_key = mix(key.value ^ row);
  const auto low = static_cast<std::uint32_t>(row_key);
  const auto high = static_cast<std::uint32_t>(row_key >> 32);
  for (int i = 0; i < count; ++i) {
    // The three-word PCG hash of Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020.
    std::uint32_t x = static_cast<std::uint32_t>(i) * 1664525U + 1013904223U;
    std::uint32_t y = low;
    std::uint32_t z = high;
    x += y * z;
    y += z * x;
    z += x * y;
    x ^= x >> 16;
    y ^= y >> 16;
    z ^= z >> 16;
    x += y * z;
    y += z * x;
    // Box-Muller: |z|^2 is exponential, the phase uniform. 31 bits of x give |z|^2; y gives the phase, as a
    // half circle of 31 bits and a sign.
    const float u = (static_cast<float>(static_cast<std::int32_t>(x >> 1)) + 0.5F) * 0x1p-31F;
    const float half_turn = static_cast<float>(static_cast<std::int32_t>(y << 1)) * 0x1p-33F;  // [-1/4, 1/4]
    const std::uint32_t sign = y & 0x80000000U;
    const float amplitude =
        std::bit_cast<float>(std::bit_cast<std::uint32_t>(std::sqrt(minus_log(u))) ^ sign);
    real[i] = amplitude * sine_quarter(0.25F - std::fabs(half_turn));
    imaginary[i] = amplitude * sine_quarter(half_turn);
  }
}

}  // namespace sonard::render
