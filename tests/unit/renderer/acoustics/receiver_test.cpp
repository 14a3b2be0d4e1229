// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/receiver.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/acoustics/beam_correlation.hpp"
#include "renderer/acoustics/random.hpp"
#include "renderer/acoustics/tvg.hpp"
#include "tests/unit/renderer/acoustics/receiver_bench.hpp"

namespace sonard::render {
namespace {

constexpr int beams = 256;

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
    for (int line = 0; line < samples.bins; ++line) {
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

TEST(Receiver, SpeckleIsRayleighAndCorrelatedByTheArray) {
  WorkerPool workers;
  expect_rayleigh(Receiver().receive(uniform_echo(1500, 0.01F), bare_request(1500), 0, workers), 0.1);
}

TEST(Receiver, NoiseFillsEmptyWaterWithTheSameCorrelation) {
  WorkerPool workers;
  PingRequest request = bare_request(1500);
  request.settings.physical.noise.on = true;
  request.settings.physical.noise.level_db = -20;
  expect_rayleigh(Receiver().receive(uniform_echo(1500, 0), request, 0, workers), 0.1);
}

/// Amplitudes, re full scale, of every 8th beam: beams that far from each other are independent.
std::vector<double> independent_amplitudes(const PingSamples& samples) {
  std::vector<double> amplitudes;
  for (std::size_t i = 0; i < samples.u16.size(); i += 8) {
    amplitudes.push_back(samples.u16[i] / 65535.0);
  }
  return amplitudes;
}

/// Largest distance of the distribution from Rayleigh's with E A^2 = `power`.
double distance_from_rayleigh(std::vector<double> amplitudes, double power) {
  std::sort(amplitudes.begin(), amplitudes.end());
  const auto n = static_cast<double>(amplitudes.size());
  double largest = 0;
  for (std::size_t i = 0; i < amplitudes.size(); ++i) {
    const double expected = 1 - std::exp(-amplitudes[i] * amplitudes[i] / power);
    largest = std::max({largest, std::abs(expected - static_cast<double>(i) / n),
                        std::abs(expected - static_cast<double>(i + 1) / n)});
  }
  return largest;
}

// Kolmogorov and Smirnov: among n true Rayleigh amplitudes the distance exceeds 1.95 / sqrt(n) once in a
// thousand. Moments: E A^2 = I, E A^4 = 2 I^2, whose standard errors are I / sqrt(n) and sqrt(20) I^2 /
// sqrt(n); four of each.
TEST(Receiver, AmplitudesAreRayleighInDistributionAndMoments) {
  WorkerPool workers;
  PingRequest request = bare_request(3000);
  const PingSamples speckle = Receiver().receive(uniform_echo(3000, 0.01F), request, 0, workers);
  request.settings.physical.noise.on = true;
  request.settings.physical.noise.level_db = -20;
  const PingSamples noise = Receiver().receive(uniform_echo(3000, 0), request, 0, workers);
  const PingSamples both = Receiver().receive(uniform_echo(3000, 0.01F), request, 0, workers);
  const std::vector<std::pair<const PingSamples*, double>> cases = {
      {&speckle, 0.01}, {&noise, 0.01}, {&both, 0.02}};
  for (const auto& [samples, power] : cases) {
    const std::vector<double> amplitudes = independent_amplitudes(*samples);
    const double root = std::sqrt(static_cast<double>(amplitudes.size()));
    EXPECT_LT(distance_from_rayleigh(amplitudes, power), 1.95 / root);
    double second = 0, fourth = 0;
    for (const double a : amplitudes) {
      second += a * a;
      fourth += a * a * a * a;
    }
    EXPECT_NEAR(second / (root * root) / power, 1, 4 / root);
    EXPECT_NEAR(fourth / (root * root) / (power * power), 2, 4 * std::sqrt(20.0) / root);
  }
}

/// Correlation of two intensities over all pairs of cells that lie `beam_lag` and `line_lag` apart. For
/// complex Gaussians it is exactly the square of the correlation of their fields.
double intensity_correlation(const PingSamples& first, const PingSamples& second, int beam_lag,
                             int line_lag) {
  double sum = 0, sum_a = 0, sum_b = 0, square_a = 0, square_b = 0;
  double n = 0;
  for (int line = 0; line + line_lag < first.bins; ++line) {
    for (int b = 0; b + beam_lag < first.beams; ++b, ++n) {
      const double a = std::pow(first.u16[static_cast<std::size_t>(line * beams + b)], 2);
      const double c =
          std::pow(second.u16[static_cast<std::size_t>((line + line_lag) * beams + b + beam_lag)], 2);
      sum += a * c;
      sum_a += a;
      sum_b += c;
      square_a += a * a;
      square_b += c * c;
    }
  }
  const double mean_a = sum_a / n;
  const double mean_b = sum_b / n;
  return (sum / n - mean_a * mean_b) /
         std::sqrt((square_a / n - mean_a * mean_a) * (square_b / n - mean_b * mean_b));
}

// docs/physics.md 2.8: the field is correlated by .88 / .60 / .3 at lag 1 / 2 / 3 and white in range. About
// 256 / 4 beams of a line are independent; bounds are four standard errors for 3000 lines.
TEST(Receiver, FieldsAreCorrelatedByTheArrayAcrossBeamsAndNotInRange) {
  WorkerPool workers;
  PingRequest request = bare_request(3000);
  const PingSamples speckle = Receiver().receive(uniform_echo(3000, 0.01F), request, 0, workers);
  request.settings.physical.noise.on = true;
  request.settings.physical.noise.level_db = -20;
  const PingSamples noise = Receiver().receive(uniform_echo(3000, 0), request, 0, workers);
  const double bound = 4 / std::sqrt(3000.0 * 256 / 4);
  for (const PingSamples* samples : {&speckle, &noise}) {
    EXPECT_NEAR(std::sqrt(intensity_correlation(*samples, *samples, 1, 0)), 0.88, 0.03);
    EXPECT_NEAR(std::sqrt(intensity_correlation(*samples, *samples, 2, 0)), 0.60, 0.03);
    EXPECT_NEAR(std::sqrt(intensity_correlation(*samples, *samples, 3, 0)), 0.30, 0.04);
    EXPECT_NEAR(intensity_correlation(*samples, *samples, 8, 0), 0, bound);
    EXPECT_NEAR(intensity_correlation(*samples, *samples, 0, 1), 0, bound);
  }
  EXPECT_NEAR(intensity_correlation(speckle, noise, 0, 0), 0, bound);
}

TEST(Receiver, TvgLiftsByTheDocumentedLawUpToItsCeiling) {
  PhysicalModel model;
  model.tvg.log_coefficient = 30;
  model.tvg.absorption_db_per_m = 0.2;
  model.tvg.max_db = 50;
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
  PingRequest request = bare_request(4000);
  request.settings.range.compression_log2 = 2;
  const PingSamples mean = Receiver().receive(uniform_echo(4000, 0.01F), request, 0, workers);
  EXPECT_EQ(mean.bins, 1000);
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
  PingRequest request = bare_request(700);
  request.settings.physical.noise.on = true;
  request.settings.physical.noise.level_db = -30;
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
  PingRequest request = bare_request(400);
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

// rho = exp(-(dx / l)^2 - (dpsi / l_psi)^2) per ping (docs/physics.md 2.8), rho^2 between intensities,
// products over several pings; noise differs in each ping.
TEST(Receiver, SpeckleFadesByTheLawOfMotionAndNoiseAtOnce) {
  WorkerPool workers;
  Receiver receiver;
  PingRequest request = bare_request(2000);
  const EchoImage echo = uniform_echo(2000, 0.01F);
  const double bound = 4 / std::sqrt(2000.0 * 256 / 4);
  const PingSamples first = receiver.receive(echo, request, 0, workers);
  double exponent = 0;
  for (const double dx : {0.005, 0.01, 0.02, 0.03}) {
    ++request.ping_number;
    request.T_world_sonar.position_m.y += dx;
    exponent += std::pow(dx / 0.05, 2);
    const PingSamples now = receiver.receive(echo, request, 0, workers);
    EXPECT_NEAR(intensity_correlation(first, now, 0, 0), std::exp(-2 * exponent), bound) << exponent;
  }
  ++request.ping_number;
  const double turn = request.settings.aperture.receive_beamwidth_rad / 4;
  request.T_world_sonar.orientation = {std::cos(turn / 2), 0, 0, std::sin(turn / 2)};
  exponent += 0.25;
  const PingSamples turned = receiver.receive(echo, request, 0, workers);
  EXPECT_NEAR(intensity_correlation(first, turned, 0, 0), std::exp(-2 * exponent), bound);

  request.settings.physical.noise.on = true;
  request.settings.physical.noise.level_db = -20;
  const EchoImage silence = uniform_echo(2000, 0);
  const PingSamples noise = receiver.receive(silence, request, 0, workers);
  ++request.ping_number;
  EXPECT_NEAR(intensity_correlation(noise, receiver.receive(silence, request, 0, workers), 0, 0), 0, bound);
}

// Lines without echo do not evolve their speckle; when the echo returns, they have faded like the others.
TEST(Receiver, SpeckleOfLinesThatHadNoEchoFadesAllTheSame) {
  WorkerPool workers;
  Receiver receiver;
  PingRequest request = bare_request(2000);
  const EchoImage echo = uniform_echo(2000, 0.01F);
  const PingSamples first = receiver.receive(echo, request, 0, workers);
  for (int ping = 1; ping <= 4; ++ping) {
    ++request.ping_number;
    request.T_world_sonar.position_m.x += 0.02;
    receiver.receive(uniform_echo(2000, 0), request, 0, workers);
  }
  ++request.ping_number;
  const PingSamples last = receiver.receive(echo, request, 0, workers);
  EXPECT_NEAR(intensity_correlation(first, last, 0, 0), std::exp(-2 * 4 * std::pow(0.4, 2)),
              4 / std::sqrt(2000.0 * 256 / 4));
  EXPECT_NEAR(statistics_of(last).cv, 0.5227, 0.005);
}

// A rule computes noise alone in lines without echo. An echo far below one code takes the other path.
TEST(Receiver, LinesWithoutEchoAreThoseWithAnEchoThatVanishes) {
  WorkerPool workers;
  PingRequest request = bare_request(300);
  request.settings.physical.noise.on = true;
  request.settings.physical.noise.level_db = -20;
  request.settings.physical.noise.broadside_stripe_db = 3.5;
  const PingSamples without = Receiver().receive(uniform_echo(300, 0), request, 0, workers);
  const PingSamples with = Receiver().receive(uniform_echo(300, 1e-30F), request, 0, workers);
  ASSERT_EQ(without.u16.size(), with.u16.size());
  for (std::size_t i = 0; i < with.u16.size(); ++i) {
    ASSERT_NEAR(without.u16[i], with.u16[i], 1);  // the factors are multiplied in another order
  }
}

TEST(Receiver, FrozenAndPerPingSpeckleDependOnTheRequestAlone) {
  WorkerPool workers;
  const EchoImage echo = uniform_echo(200, 0.01F);
  for (const auto kind : {SpeckleSettings::Kind::frozen, SpeckleSettings::Kind::per_ping}) {
    PingRequest request = bare_request(200);
    request.settings.physical.speckle.kind = kind;
    request.ping_number = 9;
    const PingSamples alone = Receiver().receive(echo, request, 0, workers);
    Receiver receiver;
    PingRequest other = request;
    other.ping_number = 8;
    other.T_world_sonar.position_m.x = 1;
    const PingSamples before = receiver.receive(echo, other, 0, workers);
    other.settings.physical.speckle.kind = SpeckleSettings::Kind::ou;
    receiver.receive(echo, other, 0, workers);
    EXPECT_EQ(receiver.receive(echo, request, 0, workers).u16, alone.u16);
    EXPECT_EQ(before.u16 == alone.u16, kind == SpeckleSettings::Kind::frozen);
  }
}

// Tables from the settings are kept between pings, but not beyond a change of the settings.
TEST(Receiver, FollowsEveryChangeOfItsSettings) {
  WorkerPool workers;
  Receiver receiver;
  PingRequest request = bare_request(200);
  request.settings.physical.speckle.kind = SpeckleSettings::Kind::frozen;
  request.settings.physical.noise.on = true;
  request.settings.physical.noise.level_db = -40;
  const EchoImage echo = uniform_echo(200, 0.001F);
  const std::vector<std::function<void(SonarSettings&)>> changes = {
      [](SonarSettings& s) { s.physical.gain_db = 6; },
      [](SonarSettings& s) { s.physical.noise.level_db = -30; },
      [](SonarSettings& s) { s.physical.noise.broadside_stripe_db = 3; },
      [](SonarSettings& s) { s.physical.tvg.log_coefficient = 10; },
      [](SonarSettings& s) { s.range.step_m = 0.02; },
      [](SonarSettings& s) { s.range.compression_log2 = 1; },
      [](SonarSettings& s) { s.range.compression_peak = true; },
      [](SonarSettings& s) { s.aperture.receive_beamwidth_rad *= 2; },
      [](SonarSettings& s) { s.aperture.beam_edges_rad = equal_angle_edges(beams, 1.5); },
      [](SonarSettings& s) { s.physical.near_field_blank_m = 0.5; },
      [](SonarSettings& s) { s.physical.noise.on = false; },
      [](SonarSettings& s) { s.sixteen_bit = false; }};
  PingSamples last = receiver.receive(echo, request, 0, workers);
  for (const auto& change : changes) {
    change(request.settings);
    const PingSamples kept = receiver.receive(echo, request, 0, workers);
    const PingSamples fresh = Receiver().receive(echo, request, 0, workers);
    EXPECT_EQ(kept.u16, fresh.u16);
    EXPECT_EQ(kept.u8, fresh.u8);
    EXPECT_NE(kept.u16, last.u16);
    last = kept;
  }
}

/// Filtered white field of one line in double precision.
std::vector<std::complex<double>> plain_field(RandomKey key, int line, const std::vector<float>& kernel,
                                              int count, int reach) {
  const int width = count + 2 * reach;
  std::vector<float> re(static_cast<std::size_t>(width)), im(re.size());
  fill_complex_gaussian(key, static_cast<std::uint32_t>(line), width, re.data(), im.data());
  const int half = static_cast<int>(kernel.size()) / 2;
  std::vector<std::complex<double>> field;
  for (int b = 0; b < count; ++b) {
    std::complex<double> sum;
    for (int j = -half; j <= half; ++j) {
      const auto at = static_cast<std::size_t>(b + reach + j);
      sum += static_cast<double>(kernel[static_cast<std::size_t>(j + half)]) *
             std::complex<double>(static_cast<double>(re[at]), static_cast<double>(im[at]));
    }
    field.push_back(sum);
  }
  return field;
}

// The whole chain in plain double precision: docs/physics.md 2.8 and 2.9, TVG, stripe, mean of two lines, 16
// bits.
TEST(Receiver, AgreesWithPlainDoubleArithmetic) {
  constexpr int lines = 60;
  PingRequest request = bare_request(lines);
  request.settings.range = {lines, 0.05, 1, false};
  PhysicalModel& model = request.settings.physical;
  model.speckle.kind = SpeckleSettings::Kind::per_ping;
  model.tvg.log_coefficient = 30;
  model.tvg.absorption_db_per_m = 0.2;
  model.gain_db = -3;
  model.noise.on = true;
  model.noise.level_db = -30;
  model.near_field_blank_m = 0.7;
  model.noise.broadside_stripe_db = 3.5;
  request.ping_number = 3;
  EchoImage echo = uniform_echo(lines, 0);
  for (std::size_t i = 0; i < echo.intensity.size(); ++i) {
    echo.intensity[i] =
        i % 60 < 40 ? 1e-5F * static_cast<float>(i % 997) : 0.0F;  // the last lines have no echo
  }
  WorkerPool workers;
  const PingSamples samples = Receiver().receive(echo, request, 0, workers);

  const std::vector<float> kernel = receive_kernel(request.settings.aperture);
  const int reach = (BeamFilter(kernel, beams).row_width() - beams) / 2;
  std::vector<double> sum(static_cast<std::size_t>(beams) * lines / 2, 0.0);
  for (int line = 0; line < lines; ++line) {
    const double range_m = (line + 0.5) * 0.05;
    if (range_m < 0.7) {
      continue;
    }
    const double gain_db = 30 * std::log10(range_m) + 2 * 0.2 * range_m - 3;
    const auto z = plain_field(make_random_key(5, 0, RandomField::speckle, 3), line, kernel, beams, reach);
    const auto n = plain_field(make_random_key(5, 0, RandomField::noise, 3), line, kernel, beams, reach);
    for (int b = 0; b < beams; ++b) {
      const auto at = static_cast<std::size_t>(b);
      const auto& edges = request.settings.aperture.beam_edges_rad;
      const double off_axis =
          0.5 * (edges[at] + edges[at + 1]) / request.settings.aperture.receive_beamwidth_rad;
      const double noise_power =
          std::pow(10.0, -3.0) * (1 + (std::pow(10.0, 0.35) - 1) * std::exp(-off_axis * off_axis));
      const auto intensity = static_cast<double>(echo.at(b, line));
      const std::complex<double> field = std::sqrt(intensity) * z[at] + std::sqrt(noise_power) * n[at];
      sum[static_cast<std::size_t>(line / 2 * beams + b)] += std::abs(field) * std::pow(10.0, gain_db / 20);
    }
  }
  int seen = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const double expected = std::min(65535.0, 65535 * sum[i] / 2);
    ASSERT_NEAR(samples.u16[i], expected, 1 + 2e-5 * expected) << i;
    seen += samples.u16[i] > 100 ? 1 : 0;
  }
  EXPECT_GT(seen, 256 * 20);
}

TEST(Receiver, StreamsAndSeedsDoNotShareSpeckle) {
  WorkerPool workers;
  PingRequest request = bare_request(400);
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
  PingRequest request = bare_request(64);
  request.settings.sixteen_bit = false;
  request.settings.physical.speckle.kind = SpeckleSettings::Kind::off;
  const PingSamples samples = Receiver().receive(uniform_echo(64, 1e12F), request, 0, workers);
  for (const std::uint8_t v : samples.u8) {
    EXPECT_EQ(v, 255);
  }
}

TEST(Receiver, QuantisesToTheNearestCode) {
  WorkerPool workers;
  PingRequest request = bare_request(1);
  request.settings.sixteen_bit = false;
  request.settings.physical.speckle.kind = SpeckleSettings::Kind::off;
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
  PingRequest request = bare_request(200);
  request.settings.physical.noise.on = true;
  request.settings.physical.noise.level_db = -20;
  request.settings.physical.near_field_blank_m = 0.7;
  const PingSamples samples = Receiver().receive(uniform_echo(200, 0.01F), request, 0, workers);
  for (std::size_t i = 0; i < 70 * beams; ++i) {
    ASSERT_EQ(samples.u16[i], 0);
  }
  const double rest =
      std::accumulate(samples.u16.begin() + 70 * beams, samples.u16.end(), 0.0) / (130 * beams);
  EXPECT_GT(rest, 1000);
}

// docs/physics.md 2.16: +3 to 4 dB of noise in the middle of the fan, two acoustic beams wide.
TEST(Receiver, BroadsideStripeRaisesNoiseInMidFan) {
  WorkerPool workers;
  PingRequest request = bare_request(2000);
  request.settings.physical.noise.on = true;
  request.settings.physical.noise.level_db = -30;
  request.settings.physical.noise.broadside_stripe_db = 3.5;
  const PingSamples samples = Receiver().receive(uniform_echo(2000, 0), request, 0, workers);
  const auto power_db = [&](int beam) {
    double sum = 0;
    for (int line = 0; line < samples.bins; ++line) {
      sum += std::pow(samples.u16[static_cast<std::size_t>(line * beams + beam)] / 65535.0, 2);
    }
    return 10 * std::log10(sum / samples.bins);
  };
  EXPECT_NEAR(power_db(127) - power_db(60), 3.5, 0.5);
  EXPECT_NEAR(power_db(200) - power_db(60), 0, 0.4);
  EXPECT_NEAR(power_db(60), -30, 0.3);
}

PingRequest paper_request(int lines) {
  PingRequest request = bare_request(lines);
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
