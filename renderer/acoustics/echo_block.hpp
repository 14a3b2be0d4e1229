// SPDX-License-Identifier: Apache-2.0
// A few range bins of an echo image, transposed so that the beams of a line are contiguous.
#pragma once

#include "renderer/aligned_vector.hpp"
#include "renderer/ping.hpp"

namespace sonard::render {

class EchoBlock {
 public:
  /// Range bins that fit.
  static constexpr int most_lines = 32;

  explicit EchoBlock(const EchoImage& echo);

  /// Takes the lines [first, first + count), 0 < count <= most_lines.
  void load(int first, int count);

  int beams() const { return echo_.beams; }
  /// Intensity per beam of a loaded line; starts on a cache line.
  const float* line(int bin) const {
    return &rows_[static_cast<std::size_t>(bin - first_) * static_cast<std::size_t>(stride_)];
  }
  /// Intensity per beam of single points in a line; nullptr if the line has no points.
  const float* steady(int bin) const { return echo_.steady.line(bin, echo_.beams); }
  /// Intensity of the strongest beam of the line; 0 if there is no echo.
  float strongest(int bin) const;
  /// EchoImage::surface_share
  float surface_share(int bin) const {
    return echo_.surface_share.empty() ? 1.0F : echo_.surface_share[static_cast<std::size_t>(bin)];
  }

 private:
  const EchoImage& echo_;
  int first_ = 0;
  int stride_;
  AlignedVector<float> rows_;
};

}  // namespace sonard::render
