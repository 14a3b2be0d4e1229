// SPDX-License-Identifier: Apache-2.0
// K distribution: gamma distributed texture under the speckle (docs/physics.md 2.8).
#include "renderer/acoustics/texture.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/renderer/acoustics/receiver_bench.hpp"

namespace sonard::render {
namespace {

/// Mean of t^power over normal numbers, by the rectangle rule.
double moment(const TextureRoot& root, int power) {
  std::vector<float> gaussian, ones, t;
  constexpr double step = 1.0 / 256;
  for (double x = -7; x <= 7; x += step) {
    gaussian.push_back(static_cast<float>(x / std::numbers::sqrt2));
  }
  ones.assign(gaussian.size(), 1.0F);
  t.resize(gaussian.size());
  root.apply(ones.data(), gaussian.data(), static_cast<int>(t.size()), t.data());
  double sum = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double x = std::numbers::sqrt2 * static_cast<double>(gaussian[i]);
    sum += std::pow(static_cast<double>(t[i]), power) * std::exp(-x * x / 2);
  }
  return sum * step / std::sqrt(2 * std::numbers::pi);
}

// Gamma(nu, 1/nu): E t = 1, E t^2 = 1 + 1/nu, E t^3 = (1 + 1/nu)(1 + 2/nu).
TEST(Texture, IsGammaDistributed) {
  for (const double nu : {0.3, 0.5, 1.0, 1.7, 5.0, 20.0, 200.0}) {
    TextureRoot root;
    root.set(nu);
    EXPECT_NEAR(moment(root, 1), 1, 2e-3) << nu;
    EXPECT_NEAR(moment(root, 2) / (1 + 1 / nu), 1, 5e-3) << nu;
    EXPECT_NEAR(moment(root, 3) / ((1 + 1 / nu) * (1 + 2 / nu)), 1, 1.5e-2) << nu;
  }
}

// Half of an exponential distribution (nu = 1) lies below ln 2, and 1 - exp(-1) of it below 1.
TEST(Texture, HasTheQuantilesOfTheExponential) {
  TextureRoot root;
  root.set(1);
  const float gaussian[] = {0.0F, static_cast<float>(0.33747496 / std::numbers::sqrt2)};
  const float ones[] = {1.0F, 1.0F};
  float t[2];
  root.apply(ones, gaussian, 2, t);
  EXPECT_NEAR(t[0], std::numbers::ln2, 1e-3);
  EXPECT_NEAR(t[1], 1, 1e-3);
}

TEST(Texture, ScatterersGrowWithTheRange) {
  PhysicalModel model;
  model.speckle.texture_nu = 3;
  model.speckle.texture_range_m = 10;
  EXPECT_DOUBLE_EQ(scatterers_at(model.speckle, 10), 3);
  EXPECT_DOUBLE_EQ(scatterers_at(model.speckle, 25), 7.5);
}

// Index var / mean^2 of the intensity in the far half of the lines; nu is 2/3 to 4/3 of its value in the
// middle there: on average 1 + 2 <1 / nu>. About one cell in four of a line is independent. For these two
// million cells the standard error of E I^2 is 1 to 0.3 %.
TEST(Texture, ScintillationIndexIsOnePlusTwoOverNu) {
  WorkerPool workers;
  constexpr int lines = 4000;
  for (const double nu : {1.0, 2.0, 5.0}) {
    Receiver receiver;
    PingRequest request = bare_request(lines);
    PhysicalModel& model = request.settings.physical;
    model.speckle.kind = SpeckleSettings::Kind::per_ping;
    model.speckle.texture_nu = nu;
    model.speckle.texture_range_m = 0.75 * lines * request.settings.range.step_m;
    double n = 0, sum = 0, square = 0, expected = 0;
    for (request.ping_number = 0; request.ping_number < 14; ++request.ping_number) {
      const std::vector<double> intensities =
          intensities_of(receiver.receive(even_echo(request, 4e-4), request, 0, workers));
      for (std::size_t i = intensities.size() / 2; i < intensities.size(); ++i, ++n) {
        sum += intensities[i];
        square += intensities[i] * intensities[i];
        expected += 1 + 2 * 0.75 * lines / (nu * (static_cast<double>(i / 256) + 0.5));
      }
    }
    EXPECT_NEAR(sum / n / 4e-4, 1, 0.01) << nu;
    EXPECT_NEAR((square / n / std::pow(sum / n, 2) - 1) / (expected / n), 1, 0.02) << nu;
  }
}

// Texture belongs to the scene: it stays while the sonar rests and changes as the sonar moves.
TEST(Texture, StaysWhileTheSonarRests) {
  WorkerPool workers;
  Receiver receiver;
  PingRequest request = bare_request(300);
  request.settings.physical.speckle.texture_nu = 1;
  const std::vector<std::uint16_t> first =
      receiver.receive(even_echo(request, 0.01), request, 0, workers).u16;
  ++request.ping_number;
  EXPECT_EQ(receiver.receive(even_echo(request, 0.01), request, 0, workers).u16, first);
  ++request.ping_number;
  request.T_world_sonar.position_m.x = 1;
  EXPECT_NE(receiver.receive(even_echo(request, 0.01), request, 0, workers).u16, first);
  request.settings.physical.speckle.texture_nu = 0;
  EXPECT_NE(receiver.receive(even_echo(request, 0.01), request, 0, workers).u16, first);
}

}  // namespace
}  // namespace sonard::render
