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

#include "renderer/acoustics/transducer.hpp"
#include "renderer/errors.hpp"

namespace sonard::render {
namespace {

using Shape = PulseSettings::Shape;

constexpr double pulse_m = 0.0075;  // 100 kHz at 1500 m/s

EchoImage image_of(int beams, std::vector<float> intensity) {
  return {beams, static_cast<int>(intensity.size()) / beams, std::move(intensity)};
}

double sum(const EchoImage& image) {
  return std::accumulate(image.intensity.begin(), image.intensity.end(), 0.0);
}

/// Share of an echo, spread evenly over its line, in the line `lines` away: the response integrated over both
/// by the midpoint rule.
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
    const PulseResponse response(Shape::chirp, pulse_m, step_m);
    ASSERT_GT(response.taps(), 3);
    for (int lines = 0; lines < 4; ++lines) {
      // 0.6 % of the energy lies beyond 16 cells; the response spreads it over the rest.
      EXPECT_NEAR(response.share(lines), integral(step_m, lines), 0.007 * response.share(0))
          << step_m << ' ' << lines;
    }
  }
}

TEST(PulseResponse, NothingIsLost) {
  const PulseResponse response(Shape::chirp, pulse_m, 0.0024);
  std::vector<float> intensity(1200, 0.0F);
  intensity[300] = 2.0F;
  intensity[900] = 1.0F;
  EchoImage out;
  WorkerPool workers(2);
  response.apply(image_of(2, intensity), out, workers);
  EXPECT_EQ(out.beams, 2);
  EXPECT_EQ(out.bins, 600);
  EXPECT_NEAR(sum(out), 3.0, 1e-5);
  for (int away = 0; away < response.taps(); ++away) {
    EXPECT_FLOAT_EQ(out.at(0, 300 + away), static_cast<float>(2 * response.share(away)));
    EXPECT_FLOAT_EQ(out.at(0, 300 - away), out.at(0, 300 + away));
    EXPECT_FLOAT_EQ(out.at(1, 300 + away), out.at(0, 300 + away) / 2);
  }
}

TEST(PulseResponse, StaysInsideItsBeamAndImage) {
  const PulseResponse response(Shape::chirp, pulse_m, 0.0075);
  EchoImage out;
  WorkerPool workers(2);
  response.apply(image_of(2, {1, 0, 0, 0, 0, 0}), out, workers);
  EXPECT_FLOAT_EQ(out.at(0, 0), static_cast<float>(response.share(0)));
  EXPECT_FLOAT_EQ(out.at(0, 2), static_cast<float>(response.share(2)));
  EXPECT_EQ(out.at(1, 0), 0.0F);
}

/// Level of a pulse `away_m` from the echo, in lines so short that they do not blur it.
double level_db(Shape pulse, double away_m) {
  constexpr double line_m = pulse_m / 40;
  const PulseResponse response(pulse, pulse_m, line_m);
  return 10 * std::log10(response.share(static_cast<int>(std::lround(away_m / line_m))) / response.share(0));
}

// docs/physics.md 2.6.
TEST(PulseResponse, PulsesHaveTheWidthAndSideLobesOfTheirKind) {
  // sinc^2 is one half at 0.443 cells; its first side lobe, at 1.43 cells, is 13.3 dB down.
  EXPECT_NEAR(level_db(Shape::chirp, 0.443 * pulse_m), -3, 0.15);
  EXPECT_NEAR(level_db(Shape::chirp, 1.43 * pulse_m), -13.26, 0.1);
  EXPECT_NEAR(level_db(Shape::chirp, 2.46 * pulse_m), -17.83, 0.1);
  // A Hann window makes it 1.63 times as wide; its first zero is at 2 cells, its highest side lobe 31.5 dB
  // down.
  EXPECT_NEAR(level_db(Shape::windowed_chirp, 1.63 * 0.443 * pulse_m), -3, 0.15);
  double highest = -100;
  for (double cells = 2; cells < 6; cells += 0.025) {
    highest = std::max(highest, level_db(Shape::windowed_chirp, cells * pulse_m));
  }
  EXPECT_NEAR(highest, -31.5, 0.1);
  // A tone is even over its length and zero beyond.
  EXPECT_NEAR(level_db(Shape::tone, 0.45 * pulse_m), 0, 1e-6);
  const PulseResponse tone(Shape::tone, pulse_m, pulse_m / 40);
  EXPECT_EQ(tone.taps(), 21);  // the last one catches half a line
  EXPECT_NEAR(tone.share(20), tone.share(0) / 2, 1e-6);
}

// A tone of length l, its middle anywhere in a line of length d >= l, is outside of it by l / 4d in the mean.
TEST(PulseResponse, ToldWhatIsHeardOutsideOfTheLine) {
  EXPECT_NEAR(PulseResponse(Shape::tone, 0.01, 0.02).share_outside(), 0.125, 1e-6);
  EXPECT_NEAR(PulseResponse(Shape::tone, 0.01, 0.5).share_outside(), 0.005, 1e-6);
  EXPECT_NEAR(PulseResponse(Shape::chirp, 0.01, 0.02).share_outside(), 1 - integral(2 * pulse_m, 0), 0.01);
}

/// A tone of length `cell_m`; levels are stated for a tone of 20 mm in lines of 5 mm.
PulseSettings tone_of(double cell_m, double rounding_m = 0) {
  return {Shape::tone, cell_m, rounding_m, {0.02, 0.005}};
}

PulseResponse response_of(const PulseSettings& pulse, double step_m) {
  return {pulse.shape, pulse.range_cell_m, step_m, pulse.tone_rounding_m, pulse_energy(pulse, step_m)};
}

/// Level of an even echo of 1.
double bed(const PulseResponse& response) {
  double sum = response.share(0);
  for (int lines = 1; lines < response.taps(); ++lines) {
    sum += 2 * response.share(lines);
  }
  return sum;
}

// The source level is fixed. The usual tone is 4 lines of 5 mm long, so a resolved point has a quarter of its
// echo, and an even echo has a quarter for each line in the tone.
TEST(PulseEnergy, ALongerToneLeavesAPointAndRaisesABed) {
  for (const double cell_m : {0.005, 0.02, 0.1, 0.75}) {
    const PulseSettings pulse = tone_of(cell_m);
    EXPECT_NEAR(bed(response_of(pulse, 0.005)), cell_m / 0.02, 1e-4 * cell_m / 0.02) << cell_m;
    EXPECT_NEAR(response_of(pulse, 0.0002).share(0), 0.25, 0.25 * 0.02) << cell_m;
  }
  EXPECT_NEAR(bed(response_of(tone_of(0.02), 0.005)), 1, 1e-6);
}

// An even echo has its energy per line, so lines twice as long hold twice as much and have the same level. A
// tone shorter than its line has its mean over the line.
TEST(PulseEnergy, LevelsDoNotDependOnTheLengthOfLines) {
  for (const double step_m : {0.001, 0.005, 0.01, 0.04}) {
    EXPECT_NEAR(bed(response_of(tone_of(0.1), step_m)) * step_m / 0.005, 0.1 / 0.02, 1e-3) << step_m;
  }
  const PulseResponse response = response_of(tone_of(0.005), 0.5);
  EXPECT_NEAR(bed(response), 0.25 * 0.005 / 0.5, 1e-6);
}

// A tone with rounded ends keeps its peak and its length, but is at least as long as the square of the lobe:
// 0.9028 of its half, by quadrature of (sin(pi x) / (pi x))^2 in other software.
TEST(PulseEnergy, ARoundedToneKeepsItsPeakAndItsLength) {
  constexpr double rounding_m = 0.018;
  for (const double cell_m : {0.004, 0.0126, 0.02, 0.033, 0.13}) {
    const PulseSettings pulse = tone_of(cell_m, rounding_m);
    const double length_m = std::max(cell_m, 0.9028 * rounding_m);
    EXPECT_NEAR(bed(response_of(pulse, 0.005)), length_m / 0.02, 1e-3 * length_m / 0.02) << cell_m;
    EXPECT_NEAR(response_of(pulse, 0.0005).share(0), 0.25, 0.25 * 0.01) << cell_m;
  }
}

// The convolution of a box with the main lobe of a sinc, computed again. Other software found the box that
// gives a length of 33.2 mm.
TEST(PulseResponse, ARoundedToneIsABoxBehindABand) {
  constexpr double rounding_m = 0.018, box_m = 0.0417, dx = 1e-5, step_m = 0.0005;
  const auto amplitude = [](double x) {
    double sum = 0;
    for (double at = -rounding_m + dx / 2; at < rounding_m; at += dx) {
      const double y = std::numbers::pi * at / rounding_m;
      sum += std::abs(x - at) <= box_m / 2 ? std::sin(y) / y : 0.0;
    }
    return sum;
  };
  const PulseResponse response(Shape::tone, 0.0332, step_m, rounding_m);
  for (const int lines : {10, 20, 30, 40, 50}) {
    const double expected = std::pow(amplitude(lines * step_m) / amplitude(0), 2);
    EXPECT_NEAR(response.share(lines) / response.share(0), expected, 0.01) << lines;
  }
}

TEST(PulseEnergy, IsOneWhereLevelsDoNotFollowTheLength) {
  PulseSettings pulse = tone_of(0.1);
  pulse.usual = {};
  EXPECT_EQ(pulse_energy(pulse, 0.01), 1);
  pulse = tone_of(0.1);
  pulse.shape = Shape::windowed_chirp;
  EXPECT_EQ(pulse_energy(pulse, 0.01), 1);
  pulse.band_loss_db = -20;
  EXPECT_NEAR(pulse_energy(pulse, 0.01), 0.01, 1e-12);
  pulse = tone_of(0.02);
  EXPECT_EQ(pulse_energy(pulse, 0.005), 1);  // exactly: pictures of the usual pulse do not change
}

// By hand: a band of 200 kHz around 743.3 kHz has a quality of 3.717. 500 kHz is detuned by
// 3.717 (500 / 743.3 - 743.3 / 500) = -3.026, which leaves 1 / 10.16 of the power each way.
TEST(TransducerBand, LosesWhatAResonanceDoesTwice) {
  const TransducerBand band{650e3, 850e3};
  EXPECT_NEAR(band_loss_db(band, 650e3, 0), -6.02, 0.01);
  EXPECT_NEAR(band_loss_db(band, 850e3, 0), -6.02, 0.01);
  EXPECT_NEAR(band_loss_db(band, std::sqrt(650e3 * 850e3), 0), 0, 1e-9);
  EXPECT_NEAR(band_loss_db(band, 740e3, 53e-6), 0, 0.01);
  EXPECT_NEAR(band_loss_db(band, 500e3, 0), -20 * std::log10(10.16), 0.05);
  EXPECT_NEAR(band_loss_db(band, 1000e3, 0), -15.5, 0.1);
  EXPECT_EQ(band_loss_db({}, 500e3, 1e-6), 0);
}

// Two resonators in a row, each y' = (x - y) / t with t = 1 / (pi * 200 kHz), step by step.
TEST(TransducerBand, AShortToneEndsBeforeTheTransducerHasBuiltUp) {
  constexpr double dt = 1e-10;
  for (const double duration_s : {0.5e-6, 1e-6, 2e-6, 5e-6, 20e-6}) {
    double first = 0, second = 0, most = 0;
    for (double time_s = 0; time_s < duration_s + 10e-6; time_s += dt) {
      const double tone = time_s < duration_s ? 1 : 0;
      second += dt * std::numbers::pi * 200e3 * (first - second);
      first += dt * std::numbers::pi * 200e3 * (tone - first);
      most = std::max(most, second);
    }
    EXPECT_NEAR(band_loss_db({650e3, 850e3}, std::sqrt(650e3 * 850e3), duration_s), 20 * std::log10(most),
                0.02)
        << duration_s;
  }
}

TEST(PulseResponse, APulseWithoutLengthSpreadsNothing) {
  EXPECT_EQ(PulseResponse().taps(), 0);
  EXPECT_EQ(PulseResponse(Shape::point, 0.01, 0.01).taps(), 0);
  EXPECT_EQ(PulseResponse(Shape::chirp, 0, 0.01).taps(), 0);
}

}  // namespace
}  // namespace sonard::render
