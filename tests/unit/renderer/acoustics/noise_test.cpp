// SPDX-License-Identifier: Apache-2.0
// The level of noise, interference and the ring-down (docs/physics.md 2.9, 2.16).
#include "renderer/acoustics/noise.hpp"

#include <cmath>
#include <limits>
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
  EXPECT_NEAR(noise_level_db(budget), PhysicalModel().noise.level_db, 0.2);
}

TEST(Noise, InterferenceIsDrawnEvenlyBySeed) {
  const Interference settings{0.07, 2, 11, 4, 0.1};
  const RangeBins range{1000, 0.05, 0, false};
  constexpr int pings = 100'000;
  double hit = 0, first = 0, raise_db = 0, longer = 0, to_the_end = 0;
  for (int ping = 0; ping < pings; ++ping) {
    const auto key = make_random_key(1, 0, RandomField::interference, static_cast<std::uint64_t>(ping));
    const InterferenceBurst burst = draw_interference(settings, range, key);
    if (burst.factor == 1.0F) {
      continue;
    }
    ++hit;
    first += burst.first_line;
    const double db = 20 * std::log10(static_cast<double>(burst.factor));
    raise_db += db;
    EXPECT_GE(db, 2 - 1e-5);
    EXPECT_LE(db, 11 + 1e-5);
    EXPECT_TRUE(burst.raises(burst.first_line));
    EXPECT_TRUE(burst.raises(burst.end_line - 1));
    EXPECT_FALSE(burst.raises(burst.first_line - 1));
    EXPECT_FALSE(burst.raises(burst.end_line));
    const int length = burst.end_line - burst.first_line;
    to_the_end += burst.end_line == 1000 ? 1 : 0;
    if (burst.end_line < 1000) {
      EXPECT_GE(length, 40);  // half of 4 m
      EXPECT_LE(length, 160);
    }
    longer += length > 80 ? 1 : 0;
  }
  EXPECT_NEAR(hit / pings, 0.07, 4 * std::sqrt(0.07 / pings));
  EXPECT_NEAR(first / hit, 500, 4 * 289 / std::sqrt(hit));
  EXPECT_NEAR(raise_db / hit, 6.5, 4 * 2.6 / std::sqrt(hit));
  // Of 50 m: 0.1 by choice, and of the others the bursts that begin within their length of the end:
  // 4 m * 3 / (4 ln 2) / 50 m = 0.0866.
  EXPECT_NEAR(to_the_end / hit, 0.1 + 0.9 * 0.0866, 4 * 0.39 / std::sqrt(hit));
  // Half of the bursts of 4 m that end by themselves, and those to the end, if there is room.
  EXPECT_NEAR(longer / hit, 0.92 * (0.1 + 0.9 / 2), 4 * 0.5 / std::sqrt(hit) + 0.005);
}

// The strongest echo re the floor: the noise of its bin, -40 dB, and half a step of 16 bits.
TEST(Noise, TellsHowFarTheStrongestEchoStandsOutOfIt) {
  WorkerPool workers;
  const auto over_floor = [&](const PingRequest& request, const EchoImage& echo) {
    Receiver receiver;
    receiver.receive(echo, request, 0, workers);
    return receiver.echo_over_floor();
  };
  PingRequest request = bare_request(100);
  const double half_a_step = std::pow(0.5 / 65535, 2);
  EXPECT_NEAR(over_floor(request, even_echo(request, 1e-6)), 1e-6 / half_a_step, 1e-3 * 1e-6 / half_a_step);
  EXPECT_EQ(over_floor(request, even_echo(request, 0)), 0.0);
  request.settings.physical.noise.on = true;
  request.settings.physical.noise.level_db = -40;
  EXPECT_NEAR(over_floor(request, even_echo(request, 1e-6)), 1e-6 / (1e-4 + half_a_step), 1e-6);
  EchoImage one_bin = even_echo(request, 1e-6);
  one_bin.intensity[37 * 100 + 52] = 1e-3F;
  EXPECT_NEAR(over_floor(request, one_bin), 10.0, 1e-3);
  one_bin.surface_share.assign(100, 1.0F);
  one_bin.surface_share[52] = 0.002F;  // a fish
  EXPECT_NEAR(over_floor(request, one_bin), 0.02, 1e-4);
  request.settings.model = Model::paper;
  EXPECT_EQ(over_floor(request, even_echo(request, 0.1)), std::numeric_limits<double>::infinity());
}

// In a ping with interference, noise rises by the drawn factor from the drawn line to the drawn end, in all
// beams.
TEST(Noise, InterferenceRaisesNoiseWithinItsBurst) {
  WorkerPool workers;
  PingRequest request = bare_request(400);
  request.settings.physical.noise.on = true;
  request.settings.physical.noise.level_db = -40;
  const std::vector<double> calm =
      intensities_of(Receiver().receive(even_echo(request, 0), request, 0, workers));
  request.settings.physical.noise.interference = {1.0, 10, 10, 1.0, 0.0};
  const std::vector<double> hit =
      intensities_of(Receiver().receive(even_echo(request, 0), request, 0, workers));
  const InterferenceBurst burst =
      draw_interference(request.settings.physical.noise.interference, request.settings.range,
                        make_random_key(request.seed, 0, RandomField::interference, request.ping_number));
  ASSERT_GT(burst.first_line, 0);
  ASSERT_LT(burst.end_line, 399);
  for (std::size_t i = 0; i < hit.size(); ++i) {
    const int line = static_cast<int>(i / 256);
    const double factor = line >= burst.first_line && line < burst.end_line ? 10 : 1;
    ASSERT_NEAR(std::sqrt(hit[i]), std::sqrt(factor * calm[i]), 4.0 / 65535) << i;
  }
}

TEST(RingDown, RisesToItsPeakAndFallsBy80Decibels) {
  PhysicalModel model;
  model.ring_down = {true, -6, 0.3, 0.9};
  const RingDown& ring_down = model.ring_down;
  const RangeBins range{2000, 0.001, 0, false};
  const std::vector<float> amplitude = ring_down_amplitudes(model, range);
  const auto level_db = [&](double range_m) {
    return 20 * std::log10(static_cast<double>(amplitude[static_cast<std::size_t>(range_m / 0.001)]));
  };
  EXPECT_EQ(amplitude[149], 0.0F);
  EXPECT_NEAR(level_db(0.2255), -12, 0.1);  // half way up a half cosine
  EXPECT_NEAR(level_db(0.3), -6, 0.1);
  EXPECT_NEAR(level_db(0.6), -46, 0.1);
  EXPECT_NEAR(level_db(0.9), -86, 0.1);
  EXPECT_EQ(ring_down_bins(ring_down, range), 900);
  EXPECT_EQ(ring_down_bins({}, range), 0);
}

// The pulse overdrives the receiver: samples are even from the first line up to the peak, with any TVG.
TEST(RingDown, IsEvenFromTheFirstLineWhereThePulseOverdrivesTheReceiver) {
  PhysicalModel model;
  model.ring_down = {.on = true, .level_db = -6, .peak_m = 0.3, .end_m = 0.9, .from_start = true};
  model.tvg.log_coefficient = 30;
  model.tvg.absorption_db_per_m = 0.2;
  const std::vector<float> amplitude = ring_down_amplitudes(model, {2000, 0.001, 0, false});
  const auto output_db = [&](std::size_t line) {
    const double range_m = (static_cast<double>(line) + 0.5) * 0.001;
    return 20 * std::log10(static_cast<double>(amplitude[line])) + 30 * std::log10(range_m) + 0.4 * range_m;
  };
  for (const std::size_t line : {0, 1, 10, 144, 299}) {
    EXPECT_NEAR(output_db(line), -6 + 30 * std::log10(0.3) + 0.4 * 0.3, 0.01) << line;
  }
  EXPECT_NEAR(20 * std::log10(static_cast<double>(amplitude[600])), -46, 0.1);
  EXPECT_NEAR(20 * std::log10(static_cast<double>(amplitude[900])), -86, 0.1);
}

// Without echo and noise, the samples are the ring-down alone.
TEST(RingDown, IsHeardBeforeTheGainLikeAnEcho) {
  WorkerPool workers;
  PingRequest request = bare_request(200);
  request.settings.physical.ring_down = {true, -6, 0.3, 0.9, 0, -std::numeric_limits<double>::infinity()};
  request.settings.physical.gain_db = -6;
  const PingSamples samples = Receiver().receive(even_echo(request, 0), request, 0, workers);
  const std::vector<float> amplitude =
      ring_down_amplitudes(request.settings.physical, request.settings.range);
  for (int line = 0; line < 90; ++line) {
    const auto at = static_cast<std::size_t>(line);
    EXPECT_NEAR(samples.u16[at * 256 + 77], 65535 * static_cast<double>(amplitude[at]) * std::pow(10, -0.3),
                1)
        << line;
  }
  // Its level varies from ping to ping: sd 2 dB, here over 400 pings, which give it to 0.07 dB.
  request.settings.physical.ring_down.sd_db = 2;
  request.settings.range.count = 40;
  double sum_db = 0, squares_db = 0;
  for (request.ping_number = 1; request.ping_number <= 400; ++request.ping_number) {
    const double code = Receiver().receive(even_echo(request, 0), request, 0, workers).u16[36 * 256 + 77];
    const double db = 20 * std::log10(code / 65535 / static_cast<double>(amplitude[36])) + 6;
    sum_db += db;
    squares_db += db * db;
  }
  EXPECT_NEAR(sum_db / 400, 0, 0.4);
  EXPECT_NEAR(std::sqrt(squares_db / 400), 2, 0.3);
  request.settings.transmit = false;
  for (const std::uint16_t code : Receiver().receive(even_echo(request, 0), request, 0, workers).u16) {
    ASSERT_EQ(code, 0);
  }
}

}  // namespace
}  // namespace sonard::render
