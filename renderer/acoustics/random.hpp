// SPDX-License-Identifier: Apache-2.0
// Random numbers as a pure function of key and index: no state, no order, the same for every thread count.
#pragma once

#include <cstdint>

namespace sonard::render {

/// Names one field of random numbers.
struct RandomKey {
  std::uint64_t value = 0;
};

/// Use of a field; separates the fields of one ping.
enum class RandomField : std::uint64_t {
  speckle = 1,
  noise = 2,
  paper_speckle = 3,
  texture = 4,
  interference = 5,
  ring_down = 6,
  noise_by_bearing = 7,
  bearing_jitter = 8,
  water_clutter = 9,
  bounces = 10,
  array_elements = 16
};

/// Mixes all inputs so that any difference gives an unrelated field.
RandomKey make_random_key(std::uint64_t seed, int head, RandomField field, std::uint64_t ping_number);

/// Circular complex Gaussians CN(0, 1), that is E|z|^2 = 1, for columns 0 ... count - 1 of row `row`.
void fill_complex_gaussian(RandomKey key, std::uint32_t row, int count, float* real, float* imaginary);

/// A normal number of mean 0 and variance 1.
double normal_number(RandomKey key);

/// Number `index` of a uniform field, in [0, 1).
double uniform_number(RandomKey key, std::uint64_t index);

}  // namespace sonard::render
