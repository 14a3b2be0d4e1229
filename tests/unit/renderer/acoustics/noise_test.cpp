// SPDX-License-Identifier: Apache-2.0
// The level of noise, interference and the ring-down (docs/physics.md 2.9, 2.16).
#include "renderer/acoustics/noise.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/acoustics/ring_down.hpp"
#include "tests/unit/renderer/acoustics/receiver_bench.hpp"

namespace sonard::render {
namespace {

// docs/physics.md 2.9: 42.1 dB at 720 kHz; SL 200, DI 30, B 94 kHz.
TEST(Noise, LevelFollowsFromTheSonarEquation) {
  EXPECT_NEAR(thermal_noise_db(720e3), 42.15, 0.01);
  NoiseBudget budget;
  budget.spectral_level_db = thermal_noise_db(720e3);
  EXPECT_NEAR(noise_level_db(budget), 42.15 - 30 + 49.73 - 200, 0.01);
  EXPECT_NEAR(noise_level_db(budget), PhysicalModel().noise_level_db, 0.2);
}

TEST(Noise, InterferenceIsDrawnEvenlyBySeed) {
  const Interference settings{0.07, 2, 11};
  constexpr int pings = 100'000;
  double hit = 0, first = 0, raise_db = 0;
  for (int ping = 0; ping < pings; ++ping) {
    const auto key = make_random_key(1, 0, RandomField::interference, static_cast<std::uint64_t>(ping));
    const InterferenceStreak streak = draw_interference(settings, 1000, key);
    if (streak.factor == 1.0F) {
      continue;
    }
    ++hit;
    first += streak.first_line;
    const double db = 20 * std::log10(static_cast<double>(streak.factor));
    raise_db += db;
    EXPECT_GE(db, 2 - 1e-5);
    EXPECT_LE(db, 11 + 1e-5);
    EXPECT_TRUE(streak.raises(999));
    EXPECT_FALSE(streak.raises(streak.first_line - 1));
  }
  EXPECT_NEAR(hit / pings, 0.07, 4 * std::sqrt(0.07 / pings));
  EXPECT_NEAR(first / hit, 500, 4 * 289 / std::sqrt(hit));
  EXPECT_NEAR(raise_db / hit, 6.5, 4 * 2.6 / std::sqrt(hit));
}

// A ping that is hit: noise rises by the drawn factor from the drawn line to the end, in all beams.
TEST(Noise, InterferenceRaisesNoiseFromALineToTheEnd) {
  WorkerPool workers;
  PingRequest request = bare_request(400);
  request.settings.physical.noise = true;
  request.settings.physical.noise_level_db = -40;
  const std::vector<double> calm =
      intensities_of(Receiver().receive(even_echo(request, 0), request, 0, workers));
  request.settings.physical.interference = {1.0, 10, 10};
  const std::vector<double> hit =
      intensities_of(Receiver().receive(even_echo(request, 0), request, 0, workers));
  const int first =
      draw_interference(request.settings.physical.interference, 400,
                        make_random_key(request.seed, 0, RandomField::interference, request.ping_number))
          .first_line;
  ASSERT_GT(first, 0);
  ASSERT_LT(first, 399);
  for (std::size_t i = 0; i < hit.size(); ++i) {
    const double factor = static_cast<int>(i / 256) < first ? 1 : 10;
    ASSERT_NEAR(std::sqrt(hit[i]), std::sqrt(factor * calm[i]), 4.0 / 65535) << i;
  }
}

TEST(RingDown, RisesToItsPeakAndFallsBy80Decibels) {
  const RingDown ring_down{true, -6, 0.3, 0.9};
  const RangeLines range{2000, 0.001, 0, false};
  const std::vector<float> amplitude = ring_down_amplitudes(ring_down, range);
  const auto level_db = [&](double range_m) {
    return 20 * std::log10(static_cast<double>(amplitude[static_cast<std::size_t>(range_m / 0.001)]));
  };
  EXPECT_EQ(amplitude[149], 0.0F);
  EXPECT_NEAR(level_db(0.2255), -12, 0.1);  // half way up a half cosine
  EXPECT_NEAR(level_db(0.3), -6, 0.1);
  EXPECT_NEAR(level_db(0.6), -46, 0.1);
  EXPECT_NEAR(level_db(0.9), -86, 0.1);
  EXPECT_EQ(ring_down_lines(ring_down, range), 900);
  EXPECT_EQ(ring_down_lines({}, range), 0);
}

// Without echo and noise it is all there is; with noise it is the steady part of it.
TEST(RingDown, IsHeardBeforeTheGainLikeAnEcho) {
  WorkerPool workers;
  PingRequest request = bare_request(200);
  request.settings.physical.ring_down = {true, -6, 0.3, 0.9};
  request.settings.physical.gain_db = -6;
  const PingSamples samples = Receiver().receive(even_echo(request, 0), request, 0, workers);
  const std::vector<float> amplitude =
      ring_down_amplitudes(request.settings.physical.ring_down, request.settings.range);
  for (int line = 0; line < 90; ++line) {
    const auto at = static_cast<std::size_t>(line);
    EXPECT_NEAR(samples.u16[at * 256 + 77], 65535 * static_cast<double>(amplitude[at]) * std::pow(10, -0.3),
                1)
        << line;
  }
  request.settings.transmit = false;
  for (const std::uint16_t code : Receiver().receive(even_echo(request, 0), request, 0, workers).u16) {
    ASSERT_EQ(code, 0);
  }
}

}  // namespace
}  // namespace sonard::render
