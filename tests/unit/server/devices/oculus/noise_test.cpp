// SPDX-License-Identifier: Apache-2.0
// Noise as in lossless recordings of an M1200d at its high frequency with 256 beams. Envelopes of
// neighbouring beams are correlated by .53, .115 and .03. At a gamma of 127 the coefficient of variation is
// .28 to .30. No sample is above 254.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "protocol/oculus/ping_plan.hpp"
#include "renderer/acoustics/receiver.hpp"
#include "server/devices/oculus/config.hpp"
#include "server/devices/oculus/settings.hpp"
#include "server/devices/oculus/type.hpp"
#include "tests/support/correlation.hpp"

namespace sonard::server {
namespace {

HeadConfig m1200d() {
  HeadConfig head = oculus_type().make_default();
  auto config = std::make_shared<OculusConfig>(device_settings<OculusConfig>(head));
  config->device.plan.model = oculus::m1200d;
  config->modes = oculus_modes(oculus::m1200d);
  head.device = std::move(config);
  return head;
}

/// A ping into empty water, or with a uniform echo.
render::PingSamples ping(std::uint8_t gamma, bool sixteen_bit, float intensity = 0.0F) {
  const HeadConfig head = m1200d();
  oculus::SimpleFire fire;
  fire.fire.range = 10.0;
  fire.fire.gamma = gamma;
  fire.fire.sound_speed_mps = 1500.0;
  fire.fire.flags |= sixteen_bit ? oculus::fire_flags::sixteen_bit : 0;
  const oculus::PlanConfig& plan = device_settings<OculusConfig>(head).device.plan;
  render::PingRequest request;
  request.settings = oculus_sonar_settings(oculus::job_of(oculus::plan_ping(fire, plan), plan), head);
  const int beams = request.settings.aperture.beam_count();
  const int lines = request.settings.range.count;
  const std::vector<float> echo(static_cast<std::size_t>(beams) * static_cast<std::size_t>(lines), intensity);
  render::WorkerPool workers(2);
  render::Receiver receiver;
  return receiver.receive(render::EchoImage{beams, lines, echo, {}}, request, 0, workers);
}

/// Codes beyond 6 m, divided by the mean of the lines around them, because the level rises with range. Beams
/// of the stripe in the middle are left out.
std::vector<double> codes_of(const std::vector<std::uint16_t>& samples, int lag_beams) {
  constexpr std::size_t beams = 256;
  constexpr std::size_t end_beam = 110;
  constexpr std::size_t block_lines = 16;
  std::vector<double> codes;
  for (std::size_t line = 600; line + block_lines <= samples.size() / beams; line += block_lines) {
    const std::size_t begin = codes.size();
    double sum = 0;
    for (std::size_t i = 0; i < block_lines * end_beam; ++i) {
      const auto at = (line + i / end_beam) * beams + i % end_beam;
      codes.push_back(samples[at + static_cast<std::size_t>(lag_beams)]);
      sum += samples[at];
    }
    for (std::size_t i = begin; i < codes.size(); ++i) {
      codes[i] *= block_lines * end_beam / sum;
    }
  }
  return codes;
}

/// Coefficient of variation of numbers whose mean is 1.
double variation(const std::vector<double>& codes) {
  double square = 0;
  for (const double code : codes) {
    square += std::pow(code - 1, 2);
  }
  return std::sqrt(square / static_cast<double>(codes.size()));
}

TEST(OculusNoise, NeighbouringBeamsAreCorrelatedAsRecorded) {
  const std::vector<std::uint16_t> samples = ping(255, true).u16;
  const auto lag = [&](int beams) {
    return test::correlation(codes_of(samples, 0), codes_of(samples, beams));
  };
  EXPECT_NEAR(lag(1), 0.53, 0.05);
  EXPECT_NEAR(lag(2), 0.115, 0.04);
  EXPECT_NEAR(lag(3), 0.03, 0.03);
}

// A Rayleigh amplitude has a coefficient of 0.5227; to the power of about a half it has 0.2805.
TEST(OculusNoise, VariesAsRecordedAtTheGammaOfClients) {
  const double at_gamma = variation(codes_of(ping(127, true).u16, 0));
  EXPECT_GE(at_gamma, 0.275);
  EXPECT_LE(at_gamma, 0.30);
  EXPECT_NEAR(variation(codes_of(ping(255, true).u16, 0)), 0.5227, 0.02);
}

TEST(OculusNoise, NoCodeIsAbove254) {
  const std::vector<std::uint8_t> samples = ping(127, false, 1e6F).u8;
  EXPECT_EQ(*std::ranges::max_element(samples), 254);
  EXPECT_GT(std::ranges::count(samples, 254), static_cast<std::ptrdiff_t>(samples.size()) / 2);
}

}  // namespace
}  // namespace sonard::server
