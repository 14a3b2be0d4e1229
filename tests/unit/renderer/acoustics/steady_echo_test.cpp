// SPDX-License-Identifier: Apache-2.0
// Points in an echo, and the share of them that beams receive.
#include "renderer/acoustics/steady_echo.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "renderer/acoustics/random.hpp"

namespace sonard::render {
namespace {

constexpr MixingReach reach{5, 4};

WorkerPool& workers() {
  static WorkerPool pool(2);
  return pool;
}

EchoImage image_of(float everywhere) {
  EchoImage image{40, 60, {}, {}};
  image.intensity.assign(40 * 60, everywhere);
  return image;
}

float& cell(EchoImage& image, int beam, int line) {
  return image.intensity[static_cast<std::size_t>(beam * image.bins + line)];
}

TEST(SteadyEcho, ASpotAloneIsAPoint) {
  EchoImage image = image_of(0);
  cell(image, 20, 30) = 3;
  cell(image, 20, 31) = 1;
  const std::vector<PointEcho> points = find_points(image, reach, 0, workers());
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].fine_beam, 20);
  EXPECT_EQ(points[0].line, 30);
  EXPECT_EQ(points[0].share, 1);
}

TEST(SteadyEcho, ASurfaceHasNone) {
  EXPECT_TRUE(find_points(image_of(1), reach, 0, workers()).empty());
  EchoImage uneven = image_of(0);
  for (std::size_t i = 0; i < uneven.intensity.size(); ++i) {
    uneven.intensity[i] = static_cast<float>(uniform_number({7}, i));
  }
  EXPECT_TRUE(find_points(uneven, reach, 0, workers()).empty());
}

// Array and pulse mix 11 x 9 cells; the spot is 3 x 3 of them.
TEST(SteadyEcho, APointHasToOutshineWhatItIsMixedWith) {
  const auto share_of = [](float bright) {
    EchoImage image = image_of(1);
    cell(image, 20, 30) = bright;
    const std::vector<PointEcho> points = find_points(image, reach, 0, workers());
    return points.empty() ? 0.0F : points[0].share;
  };
  EXPECT_EQ(share_of(80), 0);             // 88 of 178
  EXPECT_EQ(share_of(400), 1);            // 408 of 498
  EXPECT_NEAR(share_of(159), 0.5, 0.02);  // 167 of 257: half way from a half to four fifths
}

TEST(SteadyEcho, TwoInOneCellAreNone) {
  EchoImage image = image_of(0);
  cell(image, 18, 30) = 1;
  cell(image, 22, 30) = 1;
  EXPECT_TRUE(find_points(image, reach, 0, workers()).empty());
}

TEST(SteadyEcho, WhatIsFainterThanAskedForIsNotLookedAt) {
  EchoImage image = image_of(0);
  cell(image, 20, 30) = 1;
  EXPECT_TRUE(find_points(image, reach, 1, workers()).empty());
  EXPECT_EQ(find_points(image, reach, 0.9F, workers()).size(), 1u);
}

TEST(SteadyEcho, BeamsReceiveAPointThroughTheirPatternAndThePulse) {
  Aperture aperture;
  aperture.beam_edges_rad = equal_sine_edges(32, std::numbers::pi / 3);
  aperture.azimuth = Aperture::Azimuth::array;
  aperture.fine_beams = 2;
  aperture.receive_beamwidth_rad = 4 * std::numbers::pi / 180;
  const BeamPattern pattern(aperture, {1});
  EchoImage fine{pattern.fine_beams(), 60, {}, {}};
  fine.intensity.assign(static_cast<std::size_t>(fine.beams * fine.bins), 0.0F);
  const int middle = fine.beams / 2;
  cell(fine, middle, 30) = 2;
  const PulseResponse pulse(PulseSettings::Shape::tone, 0.04, 0.01);
  const SteadyEcho steady = receive_points({{middle, 30, 0.5F}}, fine, pattern, &pulse, 32);
  double sum = 0;
  for (int line = 0; line < 60; ++line) {
    const float* row = steady.line(line, 32);
    EXPECT_EQ(row != nullptr, std::abs(line - 30) < pulse.taps() + 1) << line;
    for (int beam = 0; row != nullptr && beam < 32; ++beam) {
      const double whole = pattern.share(beam, middle) * 2;
      if (std::abs(line - 30) < pulse.taps()) {
        EXPECT_LE(static_cast<double>(row[beam]),
                  0.5 * whole * static_cast<double>(pulse.share(std::abs(line - 30))) + 1e-6);
      }
      sum += static_cast<double>(row[beam]);
    }
  }
  double expected = 0;
  for (int beam = 0; beam < 32; ++beam) {
    expected += pattern.share(beam, middle);
  }
  EXPECT_NEAR(sum / expected, 1, 0.02);  // half of an echo of 2, without leakage
}

// Beams closer than their resolution see nulls of each other's main lobes, below the mean leakage of the
// elements' errors.
TEST(SteadyEcho, NoBeamReceivesLessThanNothing) {
  Aperture aperture;
  aperture.beam_edges_rad = equal_sine_edges(512, 65 * std::numbers::pi / 180);
  aperture.azimuth = Aperture::Azimuth::array;
  aperture.fine_beams = 1;
  aperture.element_amplitude_sd = 0.12;
  aperture.element_phase_sd_rad = 7 * std::numbers::pi / 180;
  const BeamPattern pattern(aperture, {1});
  EchoImage fine{pattern.fine_beams(), 3, {}, {}};
  bool some_would_be_below = false;
  for (int at = 1; at < 511; at += 15) {
    fine.intensity.assign(static_cast<std::size_t>(fine.beams * fine.bins), 0.0F);
    cell(fine, at, 1) = 1;
    for (int beam = 0; beam < 512; ++beam) {
      some_would_be_below |= pattern.share(beam, at) < pattern.share(beam, (at + 256) % 512);
    }
    const SteadyEcho steady = receive_points({{at, 1, 1.0F}}, fine, pattern, nullptr, 512);
    for (int beam = 0; beam < 512; ++beam) {
      EXPECT_GE(steady.line(1, 512)[beam], 0.0F) << at << " " << beam;
    }
  }
  EXPECT_TRUE(some_would_be_below);
}

}  // namespace
}  // namespace sonard::render
