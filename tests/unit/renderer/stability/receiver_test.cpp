// SPDX-License-Identifier: Apache-2.0
// S13 and S17 of docs/physics.md 4.3: random numbers and gain at the ends of their ranges.
#include "renderer/acoustics/receiver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/acoustics/tvg.hpp"

namespace sonard::render {
namespace {

constexpr int beams = 256;
constexpr int lines = 500;

PingRequest plain_request() {
  PingRequest request;
  SonarSettings& settings = request.settings;
  settings.aperture.beam_edges_rad = equal_sine_edges(beams, 1.0471975511965976);
  settings.range = {lines, 0.01, 0, false};
  settings.sixteen_bit = true;
  PhysicalModel& model = settings.physical;
  model.tvg.log_coefficient = model.tvg.absorption_db_per_m = model.gain_db = 0;
  model.noise.on = false;
  model.near_field_blank_m = model.noise.broadside_stripe_db = 0;
  return request;
}

EchoImage even_echo(float intensity) {
  return {beams, lines, std::vector<float>(std::size_t{beams} * lines, intensity)};
}

struct Moments {
  double mean = 0, cv = 0;
};

/// Moments of the output as a share of full scale.
Moments moments_of(const PingSamples& samples) {
  const auto count = static_cast<double>(samples.u16.size());
  Moments m;
  m.mean = std::accumulate(samples.u16.begin(), samples.u16.end(), 0.0) / count / 65535;
  double squares = 0;
  for (const std::uint16_t code : samples.u16) {
    squares += std::pow(code / 65535.0 - m.mean, 2) / count;
  }
  m.cv = m.mean > 0 ? std::sqrt(squares) / m.mean : 0;
  return m;
}

Moments heard(const PingRequest& request, float intensity) {
  Receiver receiver;
  WorkerPool workers(2);
  return moments_of(receiver.receive(even_echo(intensity), request, 0, workers));
}

double normal_density(double x) {
  return std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi);
}
double normal_distribution(double x) {
  return std::erfc(-x / std::numbers::sqrt2) / 2;
}

/// Mean of N(mean, sd^2) clamped to [0, 1].
double clamped_mean(double mean, double sd) {
  if (sd == 0) {
    return std::clamp(mean, 0.0, 1.0);
  }
  const double low = -mean / sd, high = (1 - mean) / sd;
  return mean * (normal_distribution(high) - normal_distribution(low)) +
         sd * (normal_density(low) - normal_density(high)) + 1 - normal_distribution(high);
}

// docs/physics.md 1.2, A8 and A9: I times a Gaussian (or its absolute value), clamped to [0, 1].
TEST(Extremes, S13PaperSpeckleHasItsMomentsFromNoneToHuge) {
  PingRequest request = plain_request();
  request.settings.model = Model::paper;
  PaperModel& model = request.settings.paper;
  constexpr double echo = 0.5;
  for (const double mean : {0.0, 0.4, 1.0, 1e6}) {
    for (const double sd : {0.0, 1e-12, 0.15, 10.0, 1e6}) {
      model.speckle_mean = mean;
      model.speckle_sd = sd;
      model.speckle = PaperModel::Speckle::gaussian;
      EXPECT_NEAR(heard(request, echo).mean, clamped_mean(echo * mean, echo * sd), 6e-3) << mean << ' ' << sd;
      model.speckle = PaperModel::Speckle::folded_gaussian;
      const double folded =
          sd == 0 ? clamped_mean(echo * mean, 0)
                  : clamped_mean(echo * mean, echo * sd) + clamped_mean(-echo * mean, echo * sd);
      EXPECT_NEAR(heard(request, echo).mean, folded, 6e-3) << mean << ' ' << sd;
    }
  }
}

// Rayleigh: mean sqrt(pi) / 2 of the root intensity, CV sqrt(4 / pi - 1).
TEST(Extremes, S13RayleighHoldsForTheFirstAndTheLastSeedAndPing) {
  constexpr auto last = std::numeric_limits<std::uint64_t>::max();
  PingRequest request = plain_request();
  request.settings.physical.speckle.kind = SpeckleSettings::Kind::per_ping;
  Receiver receiver;
  WorkerPool workers(2);
  std::vector<std::vector<std::uint16_t>> images;
  for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{1}, last}) {
    for (const std::uint64_t ping :
         {std::uint64_t{0}, std::uint64_t{1} << 16, std::uint64_t{1} << 32, last}) {
      request.seed = seed;
      request.ping_number = ping;
      const PingSamples samples = receiver.receive(even_echo(0.04F), request, 0, workers);
      const Moments m = moments_of(samples);
      EXPECT_NEAR(m.mean, 0.2 * std::sqrt(std::numbers::pi) / 2, 2e-3) << seed << ' ' << ping;
      EXPECT_NEAR(m.cv, std::sqrt(4 / std::numbers::pi - 1), 5e-3) << seed << ' ' << ping;
      images.push_back(samples.u16);
    }
  }
  for (std::size_t i = 0; i < images.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_NE(images[i], images[k]) << i << ' ' << k;
    }
  }
}

TEST(Extremes, S13NoiseFromNothingToFarAboveFullScale) {
  PingRequest request = plain_request();
  request.settings.physical.speckle.kind = SpeckleSettings::Kind::off;
  request.settings.physical.noise.on = true;
  for (const double level_db : {-1000.0, -300.0}) {
    request.settings.physical.noise.level_db = level_db;
    EXPECT_EQ(heard(request, 0).mean, 0) << level_db;
    EXPECT_NEAR(heard(request, 0.25F).mean, 0.5, 1e-4) << level_db;
  }
  request.settings.physical.noise.level_db = -20;
  EXPECT_NEAR(heard(request, 0).mean, 0.1 * std::sqrt(std::numbers::pi) / 2, 2e-3);
  for (const double level_db : {100.0, 300.0}) {
    request.settings.physical.noise.level_db = level_db;
    EXPECT_NEAR(heard(request, 0).mean, 1.0, 1e-4) << level_db;
  }
}

// Motion of any size, with any aperture, leaves speckle Rayleigh.
TEST(Extremes, S13SpeckleSurvivesEveryMotion) {
  PingRequest request = plain_request();
  request.settings.physical.speckle.kind = SpeckleSettings::Kind::ou;
  Receiver receiver;
  WorkerPool workers(2);
  for (const double aperture_m : {1e-12, 0.1, 1e12}) {
    request.settings.physical.speckle.aperture_m = aperture_m;
    for (const double x_m : {0.0, 1e-15, 1e-3, 1e8, -1e8, 0.0}) {
      request.T_world_sonar.position_m.x = x_m;
      ++request.ping_number;
      const Moments m = moments_of(receiver.receive(even_echo(0.04F), request, 0, workers));
      EXPECT_NEAR(m.mean, 0.2 * std::sqrt(std::numbers::pi) / 2, 2e-3) << aperture_m << ' ' << x_m;
      EXPECT_NEAR(m.cv, std::sqrt(4 / std::numbers::pi - 1), 5e-3) << aperture_m << ' ' << x_m;
    }
  }
}

// TVG at range 0 would be minus infinity dB: a line takes the gain of its middle.
TEST(Extremes, S17TvgIsFiniteFromTheFirstMicrometreOn) {
  PhysicalModel model;
  for (const double step_m : {1e-6, 0.01, 1e4}) {
    for (const double coefficient : {0.0, 20.0, 30.0, 40.0, 60.0}) {
      model.tvg.log_coefficient = coefficient;
      model.tvg.absorption_db_per_m = 10;
      const std::vector<float> gain = tvg_amplitudes(model, {10, step_m, 0, false});
      const double first_db =
          std::min(coefficient * std::log10(step_m / 2) + 20 * step_m / 2, model.tvg.max_db);
      EXPECT_NEAR(20 * std::log10(static_cast<double>(gain[0])), first_db + model.gain_db, 1e-3);
      for (std::size_t k = 0; k < gain.size(); ++k) {
        EXPECT_TRUE(std::isfinite(gain[k]) && gain[k] > 0) << step_m << ' ' << coefficient;
        EXPECT_LE(20 * std::log10(static_cast<double>(gain[k])), model.tvg.max_db + model.gain_db + 1e-3);
      }
    }
  }
}

// An echo far above full scale gives the highest code in both formats and does not wrap around.
TEST(Extremes, S17SaturationEverywhereDoesNotWrap) {
  PingRequest request = plain_request();
  request.settings.physical.speckle.kind = SpeckleSettings::Kind::off;
  Receiver receiver;
  WorkerPool workers(2);
  for (const float intensity : {1.0F, 1.01F, 2.0F, 1e6F, 1e30F, std::numeric_limits<float>::max()}) {
    request.settings.sixteen_bit = true;
    const PingSamples wide = receiver.receive(even_echo(intensity), request, 0, workers);
    EXPECT_EQ(*std::min_element(wide.u16.begin(), wide.u16.end()), 65535) << intensity;
    request.settings.sixteen_bit = false;
    const PingSamples narrow = receiver.receive(even_echo(intensity), request, 0, workers);
    EXPECT_EQ(*std::min_element(narrow.u8.begin(), narrow.u8.end()), 255) << intensity;
  }
}

}  // namespace
}  // namespace sonard::render
