// SPDX-License-Identifier: Apache-2.0
// One line of complex numbers.
#pragma once

#include <cstdint>

#include "renderer/acoustics/beam_correlation.hpp"
#include "renderer/acoustics/random.hpp"
#include "renderer/aligned_vector.hpp"

namespace sonard::render {

/// Complex numbers of one line; not owned.
struct Phasors {
  const float* real;
  const float* imaginary;
};

/// Real and imaginary part of one line, each starting on a cache line.
class ComplexRow {
 public:
  explicit ComplexRow(int width)
      : stride_(aligned_stride(width)), parts_(2 * static_cast<std::size_t>(stride_)) {}

  /// Makes room for `width` numbers; the contents are lost if the row grows.
  void ensure_width(int width) {
    if (width > stride_) {
      *this = ComplexRow(width);
    }
  }

  float* real() { return parts_.data(); }
  float* imaginary() { return parts_.data() + stride_; }
  const float* real() const { return parts_.data(); }
  const float* imaginary() const { return parts_.data() + stride_; }

  /// Fills the row with CN(0, 1), padding included: whole vectors are faster than exact counts.
  void draw(RandomKey key, int line) {
    fill_complex_gaussian(key, static_cast<std::uint32_t>(line), stride_, real(), imaginary());
  }
  /// Sets this row to the filtered `white`.
  void filter(const BeamFilter& filter, const ComplexRow& white) {
    filter.apply(white.real(), real());
    filter.apply(white.imaginary(), imaginary());
  }

 private:
  int stride_;
  AlignedVector<float> parts_;
};

}  // namespace sonard::render
