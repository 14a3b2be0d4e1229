#include "renderer/acoustics/receiver.hpp"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

namespace sonard::render {
namespace {

constexpr int beams = 256;

PingRequest physical_request(int lines) {
  PingRequest request;
  request.settings.aperture.beam_edges_rad = equal_sine_edges(beams, 1.0471975511965976);
  request.settings.range = {lines, 0.01, 0, false};
  PhysicalModel& model = request.settings.physical;
  model.tvg_log_coefficient = 0;
  model.tvg_absorption_db_per_m = 0;
  model.gain_db = 0;
  model.noise = false;
  model.near_field_blank_m = 0;
  model.broadside_stripe_db = 0;
  model.side_lobe_floor_db = 0;
  request.settings.sixteen_bit = true;
  request.seed = 5;
  return request;
}

EchoImage uniform_echo(int lines, float intensity) {
  return {beams, lines,
          std::vector<float>(static_cast<std::size_t>(beams) * static_cast<std::size_t>(lines), intensity)};
}

struct Statistics {
  double mean = 0, cv = 0;
  std::vector<double> lag_correlation;  // of amplitude across beams, lag 0 ... 4
};

Statistics statistics_of(const PingSamples& samples) {
  const std::vector<std::uint16_t>& v = samples.u16;
  Statistics s;
  s.mean = std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
  for (int lag = 0; lag <= 4; ++lag) {
    double sum = 0;
    int n = 0;
    for (int line = 0; line < samples.lines; ++line) {
      for (int b = 0; b + lag < samples.beams; ++b, ++n) {
        const auto at = static_cast<std::size_t>(line * samples.beams + b);
        sum += (v[at] - s.mean) * (v[at + static_cast<std::size_t>(lag)] - s.mean);
      }
    }
    s.lag_correlation.push_back(sum / n);
  }
  s.cv = std::sqrt(s.lag_correlation[0]) / s.mean;
  for (int lag = 4; lag >= 0; --lag) {
    s.lag_correlation[static_cast<std::size_t>(lag)] /= s.lag_correlation[0];
  }
  return s;
}

// docs/physics.md 2.8, T12: Rayleigh amplitude has mean .8862 sqrt(I) and CV .5227; image lags .75 / .34 /
// .08 (+-.04).
void expect_rayleigh(const PingSamples& samples, double root_intensity) {
  const Statistics s = statistics_of(samples);
  EXPECT_NEAR(s.mean / 65535, 0.8862 * root_intensity, 0.01 * root_intensity);
  EXPECT_NEAR(s.cv, 0.5227, 0.005);
  EXPECT_NEAR(s.lag_correlation[1], 0.75, 0.04);
  EXPECT_NEAR(s.lag_correlation[2], 0.34, 0.04);
  EXPECT_NEAR(s.lag_correlation[3], 0.08, 0.04);
}

TEST(Receiver, SpeckleIsRayleighWithTheGrainOfTheArray) {
  WorkerPool workers;
  expect_rayleigh(Receiver().receive(uniform_echo(1500, 0.01F), physical_request(1500), 0, workers), 0.1);
}

TEST(Receiver, NoiseFillsEmptyWaterWithTheSameGrain) {
  WorkerPool workers;
  PingRequest request = physical_request(1500);
  request.settings.physical.noise = true;
  request.settings.physical.noise_level_db = -20;
  expect_rayleigh(Receiver().receive(uniform_echo(1500, 0), request, 0, workers), 0.1);
}

TEST(Receiver, TvgLiftsByTheDocumentedLawUpToItsCeiling) {
  PhysicalModel model;
  model.tvg_log_coefficient = 30;
  model.tvg_absorption_db_per_m = 0.2;
  model.tvg_max_db = 50;
  model.gain_db = 6;
  const std::vector<float> gain = tvg_amplitudes(model, {10000, 0.01, 0, false});
  const auto level_db = [&](std::size_t line) { return 20 * std::log10(static_cast<double>(gain[line])); };
  EXPECT_NEAR(level_db(999), 30 * std::log10(9.995) + 2 * 0.2 * 9.995 + 6, 1e-4);
  EXPECT_NEAR(level_db(9999), 56, 1e-4);
}

// docs/physics.md 2.16: compression acts on the speckled amplitude. Mean of 4 Rayleigh values: CV .5227 / 2;
// peak of 4: the mean of the largest of four exponentials in intensity is 25/12.
TEST(Receiver, CompressionAveragesAmplitudesOrKeepsThePeak) {
  WorkerPool workers;
  PingRequest request = physical_request(4000);
  request.settings.range.compression_log2 = 2;
  const PingSamples mean = Receiver().receive(uniform_echo(4000, 0.01F), request, 0, workers);
  EXPECT_EQ(mean.lines, 1000);
  EXPECT_NEAR(statistics_of(mean).cv, 0.5227 / 2, 0.006);
  request.settings.range.compression_peak = true;
  const PingSamples peak = Receiver().receive(uniform_echo(4000, 0.01F), request, 0, workers);
  double power = 0;
  for (const std::uint16_t v : peak.u16) {
    power += std::pow(v / 65535.0, 2);
  }
  EXPECT_NEAR(power / static_cast<double>(peak.u16.size()) / 0.01, 25.0 / 12, 0.03);
}

TEST(Receiver, IsTheSameForAnyNumberOfThreads) {
  PingRequest request = physical_request(700);
  request.settings.physical.noise = true;
  request.settings.physical.noise_level_db = -30;
  WorkerPool one(1);
  WorkerPool many(5);
  const EchoImage echo = uniform_echo(700, 0.02F);
  EXPECT_EQ(Receiver().receive(echo, request, 0, one).u16, Receiver().receive(echo, request, 0, many).u16);
}

double image_correlation(const PingSamples& a, const PingSamples& b) {
  const Statistics sa = statistics_of(a);
  const Statistics sb = statistics_of(b);
  double sum = 0, va = 0, vb = 0;
  for (std::size_t i = 0; i < a.u16.size(); ++i) {
    sum += (a.u16[i] - sa.mean) * (b.u16[i] - sb.mean);
    va += std::pow(a.u16[i] - sa.mean, 2);
    vb += std::pow(b.u16[i] - sb.mean, 2);
  }
  return sum / std::sqrt(va * vb);
}

TEST(Receiver, SpeckleOfAStillSonarIsFrozenAndFadesWithMotion) {
  WorkerPool workers;
  Receiver receiver;
  PingRequest request = physical_request(400);
  const EchoImage echo = uniform_echo(400, 0.01F);
  const PingSamples first = receiver.receive(echo, request, 0, workers);
  request.ping_number = 1;
  const PingSamples still = receiver.receive(echo, request, 0, workers);
  EXPECT_EQ(first.u16, still.u16);
  // Half the aperture is one correlation length: exp(-1) in the field, about its square in the image.
  request.ping_number = 2;
  request.T_world_sonar.position_m.x = 0.05;
  const PingSamples moved = receiver.receive(echo, request, 0, workers);
  EXPECT_NEAR(image_correlation(first, moved), std::exp(-2.0), 0.04);
  request.ping_number = 3;
  request.T_world_sonar.position_m.x = 5;
  EXPECT_NEAR(image_correlation(first, receiver.receive(echo, request, 0, workers)), 0, 0.03);
}

TEST(Receiver, StreamsAndSeedsDoNotShareSpeckle) {
  WorkerPool workers;
  PingRequest request = physical_request(400);
  const EchoImage echo = uniform_echo(400, 0.01F);
  Receiver receiver;
  const PingSamples a = receiver.receive(echo, request, 0, workers);
  const PingSamples b = receiver.receive(echo, request, 1, workers);
  request.seed = 6;
  const PingSamples c = receiver.receive(echo, request, 0, workers);
  EXPECT_NEAR(image_correlation(a, b), 0, 0.03);
  EXPECT_NEAR(image_correlation(a, c), 0, 0.03);
}

TEST(Receiver, SaturatesWithoutWrapping) {
  WorkerPool workers;
  PingRequest request = physical_request(64);
  request.settings.sixteen_bit = false;
  request.settings.physical.speckle = PhysicalModel::Speckle::off;
  const PingSamples samples = Receiver().receive(uniform_echo(64, 1e12F), request, 0, workers);
  for (const std::uint8_t v : samples.u8) {
    EXPECT_EQ(v, 255);
  }
}

TEST(Receiver, QuantisesToTheNearestCode) {
  WorkerPool workers;
  PingRequest request = physical_request(1);
  request.settings.sixteen_bit = false;
  request.settings.physical.speckle = PhysicalModel::Speckle::off;
  const auto code = [&](double amplitude) {
    return Receiver()
        .receive(uniform_echo(1, static_cast<float>(amplitude * amplitude)), request, 0, workers)
        .u8.front();
  };
  EXPECT_EQ(code(0.4 / 255), 0);
  EXPECT_EQ(code(0.6 / 255), 1);
  EXPECT_EQ(code(100.4 / 255), 100);
  EXPECT_EQ(code(1.0), 255);
}

TEST(Receiver, NearFieldIsExactlyZero) {
  WorkerPool workers;
  PingRequest request = physical_request(200);
  request.settings.physical.noise = true;
  request.settings.physical.noise_level_db = -20;
  request.settings.physical.near_field_blank_m = 0.7;
  const PingSamples samples = Receiver().receive(uniform_echo(200, 0.01F), request, 0, workers);
  for (std::size_t i = 0; i < 70 * beams; ++i) {
    ASSERT_EQ(samples.u16[i], 0);
  }
  const double rest =
      std::accumulate(samples.u16.begin() + 70 * beams, samples.u16.end(), 0.0) / (130 * beams);
  EXPECT_GT(rest, 1000);
}

// docs/physics.md 2.16: a strong echo leaks along its range line, about -25 dB.
TEST(Receiver, SideLobesLeakAlongTheRangeLine) {
  WorkerPool workers;
  PingRequest request = physical_request(1);
  request.settings.physical.speckle = PhysicalModel::Speckle::off;
  request.settings.physical.side_lobe_floor_db = -25;
  EchoImage echo = uniform_echo(1, 0);
  for (std::size_t b = 127; b < 129; ++b) {  // two beams of spacing
    echo.intensity[b] = 0.25F;
  }
  const PingSamples samples = Receiver().receive(echo, request, 0, workers);
  EXPECT_NEAR(20 * std::log10(samples.u16[10] / 32768.0), -25, 1.0);
}

// docs/physics.md 2.16: +3 to 4 dB of noise in the middle of the fan, two acoustic beams wide.
TEST(Receiver, BroadsideStripeRaisesNoiseInMidFan) {
  WorkerPool workers;
  PingRequest request = physical_request(2000);
  request.settings.physical.noise = true;
  request.settings.physical.noise_level_db = -30;
  request.settings.physical.broadside_stripe_db = 3.5;
  const PingSamples samples = Receiver().receive(uniform_echo(2000, 0), request, 0, workers);
  const auto power_db = [&](int beam) {
    double sum = 0;
    for (int line = 0; line < samples.lines; ++line) {
      sum += std::pow(samples.u16[static_cast<std::size_t>(line * beams + beam)] / 65535.0, 2);
    }
    return 10 * std::log10(sum / samples.lines);
  };
  EXPECT_NEAR(power_db(127) - power_db(60), 3.5, 0.5);
  EXPECT_NEAR(power_db(200) - power_db(60), 0, 0.4);
  EXPECT_NEAR(power_db(60), -30, 0.3);
}

PingRequest paper_request(int lines) {
  PingRequest request = physical_request(lines);
  request.settings.model = Model::paper;
  return request;
}

TEST(PaperReceiver, SpeckleIsTheDocumentedGaussian) {
  WorkerPool workers;
  const Statistics s =
      statistics_of(Receiver().receive(uniform_echo(1000, 0.5F), paper_request(1000), 0, workers));
  EXPECT_NEAR(s.mean / 65535, 0.5 * 0.40, 0.001);
  EXPECT_NEAR(s.cv, 0.15 / 0.40, 0.005);
  EXPECT_NEAR(s.lag_correlation[1], 0, 0.02);
}

TEST(PaperReceiver, ShadowsStayExactlyZero) {
  WorkerPool workers;
  for (const std::uint16_t v : Receiver().receive(uniform_echo(50, 0), paper_request(50), 0, workers).u16) {
    ASSERT_EQ(v, 0);
  }
}

TEST(PaperReceiver, Release2018HasAFloorAndFoldedSpeckle) {
  WorkerPool workers;
  PingRequest request = paper_request(50);
  request.settings.paper = PaperModel::release_2018();
  for (const std::uint16_t v : Receiver().receive(uniform_echo(50, 0), request, 0, workers).u16) {
    ASSERT_EQ(v, static_cast<std::uint16_t>(0.03F * 65535 + 0.5F));
  }
  const Statistics s = statistics_of(Receiver().receive(uniform_echo(500, 0.5F), request, 0, workers));
  EXPECT_NEAR(s.mean / 65535, 0.5 * 0.95, 0.005);  // folding moves the mean by less than 0.001
}

}  // namespace
}  // namespace sonard::render
