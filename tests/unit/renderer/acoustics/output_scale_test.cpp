// SPDX-License-Identifier: Apache-2.0
// Samples in half decibels, as a DST head sends them: v = floor(k 255 / 160) with k = round(2 L / dB), at
// most k = 120 (docs/physics.md 2.16); full scale is 80 dB. Samples in powers of the amplitude.
#include <cmath>
#include <cstdint>
#include <set>

#include <gtest/gtest.h>

#include "renderer/acoustics/receiver.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"

namespace sonard::render {
namespace {

/// One beam without noise, speckle or TVG: the sample is the level of the echo alone.
PingRequest scanning_request(int lines) {
  PingRequest request;
  request.settings.aperture.beam_edges_rad = {0.026, -0.026};
  request.settings.range = {lines, 0.05, 0, false};
  request.settings.output_scale = OutputScale::half_decibels;
  PhysicalModel& model = request.settings.physical;
  model.speckle.kind = SpeckleSettings::Kind::off;
  model.noise.on = false;
  model.tvg.log_coefficient = 0;
  model.tvg.absorption_db_per_m = 0;
  model.gain_db = 0;
  model.near_field_blank_m = 0;
  return request;
}

TEST(OutputScale, HalfDecibels) {
  // Levels a tenth of a decibel apart, from below the scale to above its end.
  std::vector<float> intensity;
  for (int i = 0; i < 1000; ++i) {
    intensity.push_back(static_cast<float>(std::pow(10.0, (i / 10.0 - 90.03) / 10)));
  }
  WorkerPool workers(1);
  Receiver receiver;
  const EchoImage echo{1, 1000, intensity};
  const PingSamples samples = receiver.receive(echo, scanning_request(1000), 0, workers);
  ASSERT_EQ(samples.u8.size(), 1000u);
  std::set<int> codes;
  for (int i = 0; i < 1000; ++i) {
    const double level_db = 80 + i / 10.0 - 90.03;
    const int k = std::clamp(static_cast<int>(std::floor(2 * level_db + 0.5)), 0, 120);
    EXPECT_EQ(samples.u8[static_cast<std::size_t>(i)], k * 255 / 160) << level_db;
    codes.insert(samples.u8[static_cast<std::size_t>(i)]);
  }
  EXPECT_EQ(codes.size(), 121u);
  EXPECT_EQ(*codes.rbegin(), 191);
}

TEST(OutputScale, SilenceIsZero) {
  WorkerPool workers(1);
  Receiver receiver;
  const EchoImage echo{1, 50, std::vector<float>(50, 0.0F)};
  for (const std::uint8_t sample : receiver.receive(echo, scanning_request(50), 0, workers).u8) {
    EXPECT_EQ(sample, 0);
  }
}

TEST(OutputScale, AMeanOfNativeLinesIsOneOfAmplitudes) {
  PingRequest request = scanning_request(64);
  request.settings.range.compression_log2 = 2;
  WorkerPool workers(1);
  Receiver receiver;
  EchoImage echo{1, 64, std::vector<float>(64, 0.0F)};
  echo.intensity[8] = 1e-4F;  // amplitude 0.01; with three empty lines 0.0025: 80 - 52.04 dB
  const PingSamples samples = receiver.receive(echo, request, 0, workers);
  EXPECT_EQ(samples.u8[2], 56 * 255 / 160);
}

/// 1000 amplitudes from 0 to 1.2 of full scale, as samples of a power of them.
PingSamples powers(double exponent, bool sixteen_bit, double full_scale = 1.0) {
  std::vector<float> intensity;
  for (int i = 0; i < 1000; ++i) {
    const double amplitude = i * 1.2e-3;
    intensity.push_back(static_cast<float>(amplitude * amplitude));
  }
  PingRequest request = scanning_request(1000);
  request.settings.output_scale = OutputScale::power;
  request.settings.output_exponent = exponent;
  request.settings.output_full_scale = full_scale;
  request.settings.sixteen_bit = sixteen_bit;
  WorkerPool workers(1);
  Receiver receiver;
  return receiver.receive(EchoImage{1, 1000, intensity}, request, 0, workers);
}

TEST(OutputScale, PowersAreRoundedDownAndEndBelowTheHighestCode) {
  for (const double exponent : {1.0, 0.75, 127.0 / 255.0, 1.0 / 255.0}) {
    const PingSamples narrow = powers(exponent, false);
    const PingSamples wide = powers(exponent, true);
    ASSERT_EQ(narrow.u8.size(), 1000U);
    ASSERT_EQ(wide.u16.size(), 1000U);
    for (std::size_t i = 1; i < 1000; ++i) {
      const double power = std::pow(static_cast<double>(i) * 1.2e-3, exponent);
      // Single precision may fall on the other side of a whole number.
      EXPECT_NEAR(narrow.u8[i], std::min(254.0, 255.0 * power - 0.5), 0.501) << exponent << " " << i;
      EXPECT_NEAR(wide.u16[i], std::min(65534.0, 65535.0 * power - 0.5), 0.55) << exponent << " " << i;
    }
    EXPECT_EQ(narrow.u8[0], 0);
    EXPECT_EQ(narrow.u8[999], 254);
    EXPECT_EQ(wide.u16[999], 65534);
  }
}

TEST(OutputScale, AGreaterFullScaleShowsWhatWouldBeClipped) {
  const PingSamples samples = powers(0.25, true, 4096.0);
  for (std::size_t i = 1; i < 1000; ++i) {
    const double code = 65535.0 * std::pow(static_cast<double>(i) * 1.2e-3 / 4096.0, 0.25);
    EXPECT_NEAR(samples.u16[i], code - 0.5, 0.55) << i;
  }
}

TEST(OutputScale, RefusesAFullScaleOfZero) {
  SonarRenderer renderer(World{}, {EngineKind::cpu, 1});
  PingRequest request = scanning_request(10);
  request.settings.output_full_scale = 0.0;
  EXPECT_THROW(renderer.render_ping(request), RequestError);
}

TEST(OutputScale, RefusesAPowerOfZero) {
  SonarRenderer renderer(World{}, {EngineKind::cpu, 1});
  PingRequest request = scanning_request(10);
  request.settings.output_exponent = 0.0;
  EXPECT_THROW(renderer.render_ping(request), RequestError);
}

TEST(OutputScale, SixteenBitsHaveNoSuchScale) {
  SonarRenderer renderer(World{}, {EngineKind::cpu, 1});
  PingRequest request = scanning_request(10);
  request.settings.sixteen_bit = true;
  EXPECT_THROW(renderer.render_ping(request), RequestError);
}

}  // namespace
}  // namespace sonard::render
