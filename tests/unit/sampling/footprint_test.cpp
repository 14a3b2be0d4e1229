#include "renderer/binning/footprint.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

namespace sonard::render {
namespace {

/// Fraction below `edge` of the sum of two uniform spreads, by brute force over one of them.
double brute_force(double centre, double a, double b, double edge) {
  constexpr int steps = 20000;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double shift = a * ((i + 0.5) / steps - 0.5);
    sum += std::clamp((edge - centre - shift) / b + 0.5, 0.0, 1.0);
  }
  return sum / steps;
}

TEST(Footprint, IsTheConvolutionOfTwoBoxes) {
  for (const auto& [a, b] : {std::pair{3.0, 1.0}, {1.0, 3.0}, {2.0, 2.0}, {5.0, 0.01}, {40.0, 7.0}}) {
    const Footprint footprint = Footprint::make(100.0F, static_cast<float>(a), static_cast<float>(b));
    for (double edge = 70; edge <= 130; edge += 0.37) {
      EXPECT_NEAR(footprint.below(static_cast<float>(edge)), brute_force(100, a, b, edge), 3e-5)
          << "a " << a << " b " << b << " edge " << edge;
    }
  }
}

TEST(Footprint, KeepsAllOfTheEcho) {
  for (const float a : {0.0F, 1e-6F, 0.5F, 3.0F, 511.0F, 1e9F}) {
    for (const float b : {0.0F, 1e-3F, 2.0F, 1e9F}) {
      const Footprint footprint = Footprint::make(1000.0F, a, b);
      EXPECT_EQ(footprint.below(footprint.rise_from - 1), 0.0F);
      EXPECT_NEAR(footprint.below(footprint.rise_from + footprint.base() + 1), 1.0F, 1e-6F);
    }
  }
}

TEST(Footprint, RisesMonotonically) {
  const Footprint footprint = Footprint::make(10.3F, 4.2F, 1.7F);
  float last = 0;
  for (float edge = 6; edge < 15; edge += 0.01F) {
    const float now = footprint.below(edge);
    EXPECT_GE(now, last - 1e-6F);
    last = now;
  }
}

}  // namespace
}  // namespace sonard::render
