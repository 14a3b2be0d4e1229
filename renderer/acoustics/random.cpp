#include "renderer/acoustics/random.hpp"

#include <bit>
#include <cmath>

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

/// -ln(u) for u in (0, 1), relative error below 2e-6: exponent and a polynomial of the mantissa, no branches.
inline float minus_log(float u) {
  const auto bits = std::bit_cast<std::int32_t>(u);
  // Shift the mantissa range to [1/sqrt 2, sqrt 2), where the series is shortest.
  const std::int32_t exponent = (bits - 0x3F3504F3) >> 23;
  const float m = std::bit_cast<float>(bits - (exponent << 23)) - 1.0F;
  // ln(1 + m) as 2 atanh(s), s = m / (2 + m), |s| < 0.1716: three odd terms leave 1e-7.
  const float s = m / (2.0F + m);
  const float s2 = s * s;
  const float log_m = 2 * s * (1 + s2 * (0.33333333F + s2 * (0.2F + s2 * 0.14285714F)));
  return -(static_cast<float>(exponent) * 0.69314718F + log_m);
}

/// sin(2 pi t) for t in [-1/4, 1/4]: Taylor terms to the ninth power, error below 4e-6.
inline float sine_quarter(float t) {
  const float x = 6.28318531F * t;
  const float x2 = x * x;
  return x * (1 + x2 * (-1.6666667e-1F + x2 * (8.3333333e-3F + x2 * (-1.9841270e-4F + x2 * 2.7557319e-6F))));
}

}  // namespace

RandomKey make_random_key(std::uint64_t seed, int stream, RandomField field, std::uint64_t ping_number) {
  std::uint64_t key = mix(seed);
  key = mix(key ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(stream)));
  key = mix(key ^ static_cast<std::uint64_t>(field));
  key = mix(key ^ ping_number);
  return {static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)};
}

SONARD_SIMD_CLONES
void fill_complex_gaussian(RandomKey key, std::uint32_t row, int count, float* real, float* imaginary) {
  for (int i = 0; i < count; ++i) {
    // The four-word PCG hash of Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020.
    constexpr std::uint32_t a = 1664525U;
    constexpr std::uint32_t c = 1013904223U;
    std::uint32_t x = static_cast<std::uint32_t>(i) * a + c;
    std::uint32_t y = row * a + c;
    std::uint32_t z = key.low * a + c;
    std::uint32_t w = key.high * a + c;
    x += y * w;
    y += z * x;
    z += x * y;
    w += y * z;
    x ^= x >> 16;
    y ^= y >> 16;
    z ^= z >> 16;
    w ^= w >> 16;
    x += y * w;
    y += z * x;
    // Box-Muller: |z|^2 is exponential, the phase uniform. 24 and 32 bits of each word are used.
    const float u = (static_cast<float>(static_cast<std::int32_t>(x >> 8)) + 0.5F) * 0x1p-24F;
    const float turn = static_cast<float>(static_cast<std::int32_t>(y)) * 0x1p-32F;  // [-1/2, 1/2)
    const float amplitude = std::sqrt(minus_log(u));
    const float folded = std::fabs(turn) < 0.25F ? turn : std::copysign(0.5F - std::fabs(turn), turn);
    real[i] = amplitude * sine_quarter(0.25F - std::fabs(turn));
    imaginary[i] = amplitude * sine_quarter(folded);
  }
}

}  // namespace sonard::render
