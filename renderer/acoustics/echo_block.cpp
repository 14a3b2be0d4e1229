// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/echo_block.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

/// The largest of numbers >= 0. Their bit patterns have the same order; as integers they have no NaN, which
/// would prevent vectorisation of the loop.
SONARD_SIMD_CLONES
float largest(const float* values, int count) {
  std::int32_t bits = 0;
  for (int i = 0; i < count; ++i) {
    bits = std::max(bits, std::bit_cast<std::int32_t>(values[i]));
  }
  return std::bit_cast<float>(bits);
}

constexpr int tile = 8;
/// One row of a tile.
using Row __attribute__((vector_size(tile * sizeof(float)))) = float;

/// Transposes one tile: three rounds of exchanging halves, quarters and single numbers between pairs of rows.
/// Unrolled, because in a loop the rows would be on the stack instead of in registers.
[[gnu::always_inline]] inline void turn_tile(const float* in, std::size_t in_stride, float* out,
                                             std::size_t out_stride) {
  Row r[tile];
  Row s[tile];
#pragma GCC unroll 8
  for (std::size_t i = 0; i < tile; ++i) {
    std::memcpy(&r[i], in + i * in_stride, sizeof(Row));
  }
#pragma GCC unroll 4
  for (std::size_t i = 0; i < tile; i += 2) {
    s[i] = __builtin_shufflevector(r[i], r[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    s[i + 1] = __builtin_shufflevector(r[i], r[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
#pragma GCC unroll 4
  for (std::size_t pair = 0; pair < tile / 2; ++pair) {
    const std::size_t i = pair + (pair & 2);  // 0, 1, 4, 5
    r[i] = __builtin_shufflevector(s[i], s[i + 2], 0, 1, 8, 9, 4, 5, 12, 13);
    r[i + 2] = __builtin_shufflevector(s[i], s[i + 2], 2, 3, 10, 11, 6, 7, 14, 15);
  }
#pragma GCC unroll 4
  for (std::size_t i = 0; i < tile / 2; ++i) {
    s[i] = __builtin_shufflevector(r[i], r[i + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    s[i + 4] = __builtin_shufflevector(r[i], r[i + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
#pragma GCC unroll 8
  for (std::size_t i = 0; i < tile; ++i) {
    std::memcpy(out + i * out_stride, &s[i], sizeof(Row));
  }
}

/// out[column * out_stride + row] = in[row * in_stride + column]
SONARD_SIMD_CLONES
void turn(const float* __restrict in, std::size_t in_stride, std::size_t rows, std::size_t columns,
          float* __restrict out, std::size_t out_stride) {
  const std::size_t whole_rows = rows / tile * tile;
  const std::size_t whole_columns = columns / tile * tile;
  for (std::size_t row = 0; row < whole_rows; row += tile) {
    for (std::size_t column = 0; column < whole_columns; column += tile) {
      turn_tile(in + row * in_stride + column, in_stride, out + column * out_stride + row, out_stride);
    }
  }
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = row < whole_rows ? whole_columns : 0; column < columns; ++column) {
      out[column * out_stride + row] = in[row * in_stride + column];
    }
  }
}

}  // namespace

EchoBlock::EchoBlock(const EchoImage& echo)
    : echo_(echo),
      stride_(aligned_stride(echo.beams)),
      rows_(static_cast<std::size_t>(most_lines) * static_cast<std::size_t>(stride_)) {}

void EchoBlock::load(int first, int count) {
  first_ = first;
  const auto lines = static_cast<std::size_t>(echo_.bins);
  turn(&echo_.intensity[static_cast<std::size_t>(first)], lines, static_cast<std::size_t>(echo_.beams),
       static_cast<std::size_t>(count), rows_.data(), static_cast<std::size_t>(stride_));
}

float EchoBlock::strongest(int bin) const {
  return largest(line(bin), echo_.beams);
}

}  // namespace sonard::render
