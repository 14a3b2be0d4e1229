// SPDX-License-Identifier: Apache-2.0
// The response of a chirp in range against its integral in double precision.
#include "renderer/acoustics/pulse.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/errors.hpp"

namespace sonard::render {
namespace {

using Pulse = PhysicalModel::Pulse;

constexpr double pulse_m = 0.0075;  // 100 kHz at 1500 m/s

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
      const double x = std::numbers::pi * (lines + (j - i) / static_cast<double>(n)) * step_m / pulse_m;
      total += x == 0 ? 1.0 : std::pow(std::sin(x) / x, 2);
    }
  }
  return total / (n * n) * step_m / pulse_m;
}

TEST(PulseResponse, SharesAreTheIntegralOfTheChirp) {
  for (const double step_m : {0.0024, 0.0075, 0.015, 0.0254}) {
    const PulseResponse response(Pulse::chirp, pulse_m, step_m);
    ASSERT_GT(response.taps(), 3);
    for (int lines = 0; lines < 4; ++lines) {
      // Beyond 16 cells lie 0.6 % of the energy, which are spread over what is left.
      EXPECT_NEAR(response.share(lines), integral(step_m, lines), 0.007 * response.share(0))
          << step_m << ' ' << lines;
    }
  }
}

TEST(PulseResponse, NothingIsLost) {
  const PulseResponse response(Pulse::chirp, pulse_m, 0.0024);
  std::vector<float> intensity(1200, 0.0F);
  intensity[300] = 2.0F;
  intensity[900] = 1.0F;
  EchoImage out;
  WorkerPool workers(2);
  response.apply(image_of(2, intensity), out, workers);
  EXPECT_EQ(out.beams, 2);
  EXPECT_EQ(out.lines, 600);
  EXPECT_NEAR(sum(out), 3.0, 1e-5);
  for (int away = 0; away < response.taps(); ++away) {
    EXPECT_FLOAT_EQ(out.at(0, 300 + away), static_cast<float>(2 * response.share(away)));
    EXPECT_FLOAT_EQ(out.at(0, 300 - away), out.at(0, 300 + away));
    EXPECT_FLOAT_EQ(out.at(1, 300 + away), out.at(0, 300 + away) / 2);
  }
}

TEST(PulseResponse, StaysInsideItsBeamAndImage) {
  const PulseResponse response(Pulse::chirp, pulse_m, 0.0075);
  EchoImage out;
  WorkerPool workers(2);
  response.apply(image_of(2, {1, 0, 0, 0, 0, 0}), out, workers);
  EXPECT_FLOAT_EQ(out.at(0, 0), static_cast<float>(response.share(0)));
  EXPECT_FLOAT_EQ(out.at(0, 2), static_cast<float>(response.share(2)));
  EXPECT_EQ(out.at(1, 0), 0.0F);
}

/// Level of a pulse `away_m` from the echo, in lines so short that they do not blur it.
double level_db(Pulse pulse, double away_m) {
  constexpr double line_m = pulse_m / 40;
  const PulseResponse response(pulse, pulse_m, line_m);
  return 10 * std::log10(response.share(static_cast<int>(std::lround(away_m / line_m))) / response.share(0));
}

// docs/physics.md 2.6.
TEST(PulseResponse, PulsesHaveTheWidthAndSideLobesOfTheirKind) {
  // sinc^2 is one half at 0.443 cells; its first side lobe, at 1.43 cells, is 13.3 dB down.
  EXPECT_NEAR(level_db(Pulse::chirp, 0.443 * pulse_m), -3, 0.15);
  EXPECT_NEAR(level_db(Pulse::chirp, 1.43 * pulse_m), -13.26, 0.1);
  EXPECT_NEAR(level_db(Pulse::chirp, 2.46 * pulse_m), -17.83, 0.1);
  // A Hann window makes it 1.63 times as wide; its first zero is at 2 cells, its highest side lobe 31.5 dB
  // down.
  EXPECT_NEAR(level_db(Pulse::windowed_chirp, 1.63 * 0.443 * pulse_m), -3, 0.15);
  double highest = -100;
  for (double cells = 2; cells < 6; cells += 0.025) {
    highest = std::max(highest, level_db(Pulse::windowed_chirp, cells * pulse_m));
  }
  EXPECT_NEAR(highest, -31.5, 0.1);
  // A tone is heard evenly over its length, and not beyond.
  EXPECT_NEAR(level_db(Pulse::tone, 0.45 * pulse_m), 0, 1e-6);
  const PulseResponse tone(Pulse::tone, pulse_m, pulse_m / 40);
  EXPECT_EQ(tone.taps(), 21);  // the last one catches half a line
  EXPECT_NEAR(tone.share(20), tone.share(0) / 2, 1e-6);
}

// A tone of length l whose middle lies evenly in a line of length d >= l is outside of it by l / 4d.
TEST(PulseResponse, ToldWhatIsHeardOutsideOfTheLine) {
  EXPECT_NEAR(PulseResponse(Pulse::tone, 0.01, 0.02).share_outside(), 0.125, 1e-6);
  EXPECT_NEAR(PulseResponse(Pulse::tone, 0.01, 0.5).share_outside(), 0.005, 1e-6);
  EXPECT_NEAR(PulseResponse(Pulse::chirp, 0.01, 0.02).share_outside(), 1 - integral(2 * pulse_m, 0), 0.01);
}

TEST(PulseResponse, APulseWithoutLengthSpreadsNothing) {
  EXPECT_EQ(PulseResponse().taps(), 0);
  EXPECT_EQ(PulseResponse(Pulse::point, 0.01, 0.01).taps(), 0);
  EXPECT_EQ(PulseResponse(Pulse::chirp, 0, 0.01).taps(), 0);
}

}  // namespace
}  // namespace sonard::render
