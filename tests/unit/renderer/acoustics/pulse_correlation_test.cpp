// SPDX-License-Identifier: Apache-2.0
// Correlation along the range if lines are shorter than the pulse (docs/physics.md 2.8).
#include "renderer/acoustics/pulse.hpp"

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/renderer/acoustics/receiver_bench.hpp"

namespace sonard::render {
namespace {

constexpr auto chirp = PulseSettings::Shape::chirp;
constexpr double step_m = 0.01;
constexpr double cell_m = 0.035;  // three and a half lines

/// Correlation of two lines `lag` apart: white numbers weighted with the main lobe of sinc(x / cell).
double field_correlation(int lag) {
  const auto amplitude = [](int line) {
    const double x = std::numbers::pi * line * step_m / cell_m;
    return std::abs(line * step_m) >= cell_m ? 0.0 : line == 0 ? 1.0 : std::sin(x) / x;
  };
  double sum = 0, power = 0;
  for (int line = -20; line <= 20; ++line) {
    sum += amplitude(line) * amplitude(line + lag);
    power += amplitude(line) * amplitude(line);
  }
  return sum / power;
}

/// Correlation of intensities `lag` lines apart in one beam. For complex Gaussian fields it is the square of
/// the fields' correlation.
double intensity_correlation(const PingSamples& samples, int lag) {
  const std::vector<double> intensities = intensities_of(samples);
  const auto apart = static_cast<std::size_t>(lag * samples.beams);
  double sum = 0, mean = 0, square = 0;
  const std::size_t pairs = intensities.size() - apart;
  for (std::size_t i = 0; i < pairs; ++i) {
    sum += intensities[i] * intensities[i + apart];
    mean += intensities[i];
    square += intensities[i] * intensities[i];
  }
  const auto n = static_cast<double>(pairs);
  return (sum / n - std::pow(mean / n, 2)) / (square / n - std::pow(mean / n, 2));
}

PingRequest fine_request(int lines) {
  PingRequest request = bare_request(lines);
  request.settings.range.step_m = step_m;
  request.settings.physical.pulse.shape = PulseSettings::Shape::chirp;
  request.settings.physical.pulse.range_cell_m = cell_m;
  return request;
}

// 3000 lines of 256 beams hold about 20000 independent cells: standard error 0.007 for correlated fields.
void expect_correlation(const PingSamples& samples, double power) {
  for (int lag = 1; lag <= 8; ++lag) {
    EXPECT_NEAR(intensity_correlation(samples, lag), std::pow(field_correlation(lag), 2), 0.03) << lag;
  }
  double sum = 0;
  for (const double intensity : intensities_of(samples)) {
    sum += intensity;
  }
  EXPECT_NEAR(sum / static_cast<double>(samples.u16.size()) / power, 1, 0.03);
}

TEST(PulseCorrelation, SquaresOfItsWeightsAddUpToOne) {
  const PulseCorrelation correlation(chirp, cell_m, step_m);
  EXPECT_EQ(correlation.reach(), 3);
  double sum = std::pow(correlation.weight(0), 2);
  for (int j = 1; j <= 3; ++j) {
    sum += 2 * std::pow(correlation.weight(j), 2);
  }
  EXPECT_NEAR(sum, 1, 1e-6);
  EXPECT_EQ(PulseCorrelation(chirp, step_m, step_m).reach(), 0);
  EXPECT_EQ(PulseCorrelation(chirp, 0, step_m).reach(), 0);
}

// A box three lines long: [1 1 1]. One of two and a half, in the middle of a line: [3/4 1 3/4]. Under a Hann
// window the main lobe is twice as wide, 1/2 where the lobe of a bare chirp is 0.
TEST(PulseCorrelation, EveryPulseHasItsShape) {
  const PulseCorrelation three(PulseSettings::Shape::tone, 3 * step_m, step_m);
  EXPECT_EQ(three.reach(), 1);
  EXPECT_NEAR(three.weight(1), three.weight(0), 1e-6);
  const PulseCorrelation two_and_a_half(PulseSettings::Shape::tone, 2.5 * step_m, step_m);
  EXPECT_NEAR(two_and_a_half.weight(1) / two_and_a_half.weight(0), 0.75, 1e-6);
  EXPECT_EQ(PulseCorrelation(PulseSettings::Shape::tone, step_m, step_m).reach(), 0);
  const PulseCorrelation windowed(PulseSettings::Shape::windowed_chirp, 2 * step_m, step_m);
  EXPECT_EQ(windowed.reach(), 3);
  EXPECT_NEAR(windowed.weight(2) / windowed.weight(0), 0.5, 1e-6);
  EXPECT_EQ(PulseCorrelation(PulseSettings::Shape::point, 3 * step_m, step_m).reach(), 0);
}

TEST(PulseCorrelation, SpeckleOfShortLinesIsCorrelatedByThePulse) {
  WorkerPool workers;
  for (const auto kind :
       {SpeckleSettings::Kind::ou, SpeckleSettings::Kind::frozen, SpeckleSettings::Kind::per_ping}) {
    PingRequest request = fine_request(3000);
    request.settings.physical.speckle.kind = kind;
    expect_correlation(Receiver().receive(even_echo(request, 0.01), request, 0, workers), 0.01);
  }
}

TEST(PulseCorrelation, NoiseOfShortLinesHasTheSame) {
  WorkerPool workers;
  PingRequest request = fine_request(3000);
  request.settings.physical.noise.on = true;
  request.settings.physical.noise.level_db = -20;
  expect_correlation(Receiver().receive(even_echo(request, 0), request, 0, workers), 0.01);
}

TEST(PulseCorrelation, LinesOfACellShareNothing) {
  WorkerPool workers;
  PingRequest request = fine_request(3000);
  request.settings.physical.pulse.shape = PulseSettings::Shape::chirp;
  request.settings.physical.pulse.range_cell_m = step_m;
  EXPECT_NEAR(intensity_correlation(Receiver().receive(even_echo(request, 0.01), request, 0, workers), 1), 0,
              0.01);
}

// A kept field keeps its correlation while it fades, even after pings without echo.
TEST(PulseCorrelation, KeptSpeckleKeepsItsCorrelationAsItFades) {
  WorkerPool workers;
  Receiver receiver;
  PingRequest request = fine_request(3000);
  for (const double intensity : {0.01, 0.0, 0.0}) {
    receiver.receive(even_echo(request, intensity), request, 0, workers);
    ++request.ping_number;
    request.T_world_sonar.position_m.x += 0.02;
  }
  expect_correlation(receiver.receive(even_echo(request, 0.01), request, 0, workers), 0.01);
}

TEST(PulseCorrelation, IsTheSameForAnyNumberOfThreads) {
  PingRequest request = fine_request(700);
  request.settings.physical.noise.on = true;
  request.settings.physical.noise.level_db = -30;
  request.settings.physical.speckle.texture_nu = 2;
  for (const auto kind : {SpeckleSettings::Kind::ou, SpeckleSettings::Kind::per_ping}) {
    request.settings.physical.speckle.kind = kind;
    WorkerPool one(1);
    WorkerPool many(5);
    EXPECT_EQ(Receiver().receive(even_echo(request, 0.02), request, 0, one).u16,
              Receiver().receive(even_echo(request, 0.02), request, 0, many).u16);
  }
}

}  // namespace
}  // namespace sonard::render
