// SPDX-License-Identifier: Apache-2.0
// Levels for different pulse lengths that a client requests, for every head with a tone: a post keeps its
// level, a bed gains 10 log10 of the length, and noise has the receiver's level (docs/physics.md 2.6, 2.9).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "protocol/gemini/ping_plan.hpp"
#include "protocol/gemini/ping_settings.hpp"
#include "protocol/ping360/make_job.hpp"
#include "renderer/acoustics/receiver.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "server/devices/gemini/config.hpp"
#include "server/devices/gemini/type.hpp"
#include "server/devices/ping360/config.hpp"
#include "server/devices/ping360/type.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard {
namespace {

/// Settings of a client's usual ping of a Gemini, with a tone of so many cycles.
render::SonarSettings gemini_with(std::uint16_t cycles, double range_m, double rounding_m = -1) {
  server::HeadConfig head = server::gemini_type().make_default();
  if (rounding_m >= 0) {
    head.acoustics.physical.pulse.tone_rounding_m = rounding_m;
  }
  gemini::PingSettings wanted;
  wanted.range_m = range_m;
  gemini::PingConfig config = gemini::make_ping_config(wanted);
  config.tx_length = cycles;
  return server::gemini_type().sonar_settings(
      gemini::plan_ping(config, server::device_settings<server::GeminiConfig>(head).device)->job, head);
}

/// Settings of a client's ping of a Ping360.
render::SonarSettings ping360_with(std::uint16_t pulse_us, std::uint16_t sample_period,
                                   std::uint16_t frequency_khz = 740) {
  const server::HeadConfig head = server::ping360_type().make_default();
  ping360::Transducer command;
  command.number_of_samples = 1200;
  command.sample_period = sample_period;
  command.transmit_duration_us = pulse_us;
  command.transmit_frequency_khz = frequency_khz;
  return server::ping360_type().sonar_settings(
      ping360::make_job(ping360::form_of(command),
                        server::device_settings<server::Ping360Config>(head).device),
      head);
}

/// The echo alone, with the same level at any range.
render::EchoImage echo_of(const render::World& world, render::SonarSettings settings) {
  settings.physical.water_clutter.density_per_m3 = 0;
  settings.physical.absorption_db_per_m = 0;
  settings.aperture.element_amplitude_sd = 0;
  settings.aperture.element_phase_sd_rad = 0;
  render::SonarRenderer renderer(world, {render::EngineKind::cpu, 1});
  render::PingRequest request;
  request.settings = settings;
  return renderer.render_echo(request);
}

/// Level of the strongest cell of a post.
double post_db(const render::SonarSettings& settings, float range_m) {
  const render::World post = test::make_world(
      {test::make_body("post", test::make_quad({range_m, -0.02F, -0.02F}, {0, 0.04F, 0}, {0, 0, 0.04F}))});
  const render::EchoImage echo = echo_of(post, settings);
  return 10 * std::log10(static_cast<double>(std::ranges::max(echo.intensity)));
}

/// Level of a bed 2 m below the head, at a range in the middle of the fan.
double bed_db(const render::SonarSettings& settings, double range_m) {
  const render::World bed =
      test::make_world({test::make_body("bed", test::make_quad({-5, -60, -2}, {120, 0, 0}, {0, 120, 0}))});
  const render::EchoImage echo = echo_of(bed, settings);
  return 10 * std::log10(static_cast<double>(
                  echo.at(echo.beams / 2, static_cast<int>(range_m / settings.range.step_m))));
}

TEST(PulseLevels, APostKeepsItsLevelUnderAGeminisTones) {
  const double usual_db = post_db(gemini_with(11, 12), 8);
  for (const std::uint16_t cycles : {4, 25, 32, 89, 128, 255}) {
    EXPECT_NEAR(post_db(gemini_with(cycles, 12), 8), usual_db, 0.5) << cycles;
  }
}

TEST(PulseLevels, ABedGainsTheLengthOfAGeminisTone) {
  const double usual_db = bed_db(gemini_with(18, 14), 9);
  for (const std::uint16_t cycles : {16, 25, 32, 64, 89, 128, 255}) {
    EXPECT_NEAR(bed_db(gemini_with(cycles, 14), 9) - usual_db, 10 * std::log10(cycles / 18.0), 0.2) << cycles;
  }
  // The band of the head limits the shortest tone: 16.3 mm, 15.7 cycles.
  for (const std::uint16_t cycles : {4, 11}) {
    EXPECT_NEAR(bed_db(gemini_with(cycles, 14), 9) - usual_db, 10 * std::log10(15.7 / 18), 0.2) << cycles;
  }
  // With sharp ends the law holds at any length.
  const double sharp_db = bed_db(gemini_with(18, 14, 0), 9);
  for (const std::uint16_t cycles : {4, 11, 32, 128}) {
    EXPECT_NEAR(bed_db(gemini_with(cycles, 14, 0), 9) - sharp_db, 10 * std::log10(cycles / 18.0), 0.2)
        << cycles;
  }
}

TEST(PulseLevels, APostKeepsItsLevelUnderAPing360sTones) {
  // Lines of 1.5 mm, which resolve the shortest tone.
  const double usual_db = post_db(ping360_with(53, 80), 1.0F);
  for (const std::uint16_t pulse_us : {10, 32, 100, 500, 1000}) {
    EXPECT_NEAR(post_db(ping360_with(pulse_us, 80), 1.0F), usual_db, 0.5) << pulse_us;
  }
}

TEST(PulseLevels, ABedGainsTheLengthOfAPing360sTone) {
  const double usual_db = bed_db(ping360_with(53, 888), 10);
  for (const std::uint16_t pulse_us : {10, 32, 100, 267, 500, 1000}) {
    EXPECT_NEAR(bed_db(ping360_with(pulse_us, 888), 10) - usual_db, 10 * std::log10(pulse_us / 53.0), 0.5)
        << pulse_us;
  }
}

// The echo of a bed during a tone is the same for any sample period.
TEST(PulseLevels, ABedOfAPing360DoesNotDependOnTheSamplePeriod) {
  const double usual_db = bed_db(ping360_with(100, 444), 8);
  EXPECT_NEAR(bed_db(ping360_with(100, 888), 8), usual_db, 0.2);
  EXPECT_NEAR(bed_db(ping360_with(100, 2222), 8), usual_db, 0.3);
}

// A transducer for 650 to 850 kHz, both ways (TransducerBand).
TEST(PulseLevels, APing360IsFarDownBesideItsBand) {
  const double usual_db = post_db(ping360_with(100, 222), 2);
  EXPECT_NEAR(post_db(ping360_with(100, 222, 650), 2) - usual_db, -6.0, 0.3);
  EXPECT_NEAR(post_db(ping360_with(100, 222, 850), 2) - usual_db, -6.0, 0.3);
  EXPECT_NEAR(post_db(ping360_with(100, 222, 500), 2) - usual_db, -20.1, 0.3);
  EXPECT_NEAR(post_db(ping360_with(100, 222, 1000), 2) - usual_db, -15.5, 0.3);
}

/// Mean level of empty water far out, in the head's half decibels, after its gain.
double noise_db(render::SonarSettings settings) {
  settings.physical.gain_db += 30;
  settings.physical.ring_down.on = false;
  settings.physical.noise.interference.probability = 0;
  settings.physical.noise.by_bearing_db = 0;
  render::PingRequest request;
  request.settings = settings;
  const render::EchoImage water{1, settings.range.count,
                                std::vector<float>(static_cast<std::size_t>(settings.range.count), 0.0F)};
  render::WorkerPool workers(1);
  double sum = 0;
  constexpr int pings = 60;
  for (request.ping_number = 0; request.ping_number < pings; ++request.ping_number) {
    const render::PingSamples samples = render::Receiver().receive(water, request, 0, workers);
    for (std::size_t i = 1000; i < 1200; ++i) {
      sum += samples.u8[i] * 80.0 / 255;
    }
  }
  return sum / (pings * 200);
}

// A filter matched to a longer tone passes less noise. A post keeps its level, so it stands further above the
// noise.
TEST(PulseLevels, NoiseOfAPing360FallsWithTheLengthOfTheTone) {
  const double usual_db = noise_db(ping360_with(53, 2222));
  EXPECT_NEAR(noise_db(ping360_with(500, 2222)) - usual_db, -10 * std::log10(500 / 53.0), 0.5);
  EXPECT_NEAR(noise_db(ping360_with(267, 2222)) - usual_db, -10 * std::log10(267 / 53.0), 0.5);
}

/// Samples of a line without an echo.
std::vector<std::uint8_t> empty_line(const render::SonarSettings& settings) {
  render::PingRequest request;
  request.settings = settings;
  const render::EchoImage water{1, settings.range.count,
                                std::vector<float>(static_cast<std::size_t>(settings.range.count), 0.0F)};
  render::WorkerPool workers(1);
  return render::Receiver().receive(water, request, 0, workers).u8;
}

// As in users' pictures: bright from the first sample, dark beyond 0.75 m; a longer tone lasts longer by its
// additional length.
TEST(PulseLevels, ThePing360IsBrightFromItsFirstSampleToTheEndOfItsRinging) {
  for (const std::uint16_t sample_period : {80, 444, 888}) {
    const render::SonarSettings settings = ping360_with(53, sample_period);
    const std::vector<std::uint8_t> line = empty_line(settings);
    const auto bin_of = [&](double range_m) {
      return static_cast<std::size_t>(range_m / settings.range.step_m);
    };
    for (std::size_t bin = 0; bin <= bin_of(0.25); ++bin) {
      ASSERT_GT(line[bin], 150) << sample_period << ' ' << bin;
    }
    EXPECT_GT(line[bin_of(0.4)], line[bin_of(0.5)]);
    EXPECT_LT(line[bin_of(0.76)], 10);
  }
  const std::vector<std::uint8_t> longer = empty_line(ping360_with(1000, 444));
  EXPECT_GT(longer[static_cast<std::size_t>(0.9 / 0.008325)], 150);  // 0.71 m further
  EXPECT_LT(longer[static_cast<std::size_t>(1.5 / 0.008325)], 10);
}

}  // namespace
}  // namespace sonard
