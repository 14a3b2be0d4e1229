// The response of a chirp in range against its integral in double precision.
#include "renderer/acoustics/range_response.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/errors.hpp"

namespace sonard::render {
namespace {

constexpr double cell_m = 0.0075;  // 100 kHz at 1500 m/s

EchoImage image_of(int beams, std::vector<float> intensity) {
  return {beams, static_cast<int>(intensity.size()) / beams, std::move(intensity)};
}

double sum(const EchoImage& image) {
  return std::accumulate(image.intensity.begin(), image.intensity.end(), 0.0);
}

/// Energy of an echo that lies evenly in its line heard in the line `lines` away: the response integrated
/// over both by the midpoint rule.
double integral(double step_m, int lines) {
  constexpr int n = 400;
  double total = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double x = std::numbers::pi * (lines + (j - i) / static_cast<double>(n)) * step_m / cell_m;
      total += x == 0 ? 1.0 : std::pow(std::sin(x) / x, 2);
    }
  }
  return total / (n * n) * step_m / cell_m;
}

TEST(RangeResponse, SharesAreTheIntegralOfTheChirp) {
  for (const double step_m : {0.0024, 0.0075, 0.015, 0.0254}) {
    const RangeResponse response(cell_m, step_m);
    ASSERT_GT(response.taps(), 3);
    for (int lines = 0; lines < 4; ++lines) {
      // Beyond 16 cells lie 0.6 % of the energy, which are spread over what is left.
      EXPECT_NEAR(response.share(lines), integral(step_m, lines), 0.007 * response.share(0))
          << step_m << ' ' << lines;
    }
  }
}

TEST(RangeResponse, NothingIsLost) {
  const RangeResponse response(cell_m, 0.0024);
  std::vector<float> intensity(1200, 0.0F);
  intensity[300] = 2.0F;
  intensity[900] = 1.0F;
  EchoImage out;
  response.apply(image_of(2, intensity), out);
  EXPECT_EQ(out.beams, 2);
  EXPECT_EQ(out.lines, 600);
  EXPECT_NEAR(sum(out), 3.0, 1e-5);
  for (int away = 0; away < response.taps(); ++away) {
    EXPECT_FLOAT_EQ(out.at(0, 300 + away), static_cast<float>(2 * response.share(away)));
    EXPECT_FLOAT_EQ(out.at(0, 300 - away), out.at(0, 300 + away));
    EXPECT_FLOAT_EQ(out.at(1, 300 + away), out.at(0, 300 + away) / 2);
  }
}

TEST(RangeResponse, StaysInsideItsBeamAndImage) {
  const RangeResponse response(cell_m, 0.0075);
  EchoImage out;
  response.apply(image_of(2, {1, 0, 0, 0, 0, 0}), out);
  EXPECT_FLOAT_EQ(out.at(0, 0), static_cast<float>(response.share(0)));
  EXPECT_FLOAT_EQ(out.at(0, 2), static_cast<float>(response.share(2)));
  EXPECT_EQ(out.at(1, 0), 0.0F);
}

TEST(RangeResponse, APulseWithoutLengthSpreadsNothing) {
  EXPECT_EQ(RangeResponse().taps(), 0);
  EXPECT_EQ(RangeResponse(0, 0.01).taps(), 0);
}

}  // namespace
}  // namespace sonard::render
