// SPDX-License-Identifier: Apache-2.0
// Single objects in the water: their density and places; the first echo hides objects behind it.
#include "renderer/acoustics/water_clutter.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

SonarSettings settings_of(double density_per_m3) {
  SonarSettings settings;
  settings.aperture.beam_edges_rad = equal_angle_edges(120, 120 * degree);
  settings.aperture.vertical_beamwidth_rad = 40 * degree;
  settings.range = {400, 0.05, 0, false};
  settings.physical.water_clutter = {density_per_m3, -45};
  return settings;
}

EchoImage clutter_of(const SonarSettings& settings, const Pose& T_world_sonar = {}, std::uint64_t seed = 1,
                     float echo = 0) {
  EchoImage image{settings.aperture.beam_count(), settings.range.count, {}, {}};
  image.intensity.assign(static_cast<std::size_t>(image.beams * image.bins), 0.0F);
  for (int beam = 0; beam < image.beams; ++beam) {
    image.intensity[static_cast<std::size_t>(beam * image.bins + 200)] = echo;  // at 10 m
  }
  add_water_clutter(settings, T_world_sonar, seed, image);
  return image;
}

std::ptrdiff_t count_of(const EchoImage& image) {
  return std::ranges::count_if(image.intensity, [](float echo) { return echo > 0; });
}

TEST(WaterClutter, IsAsDenseAndAsStrongAsAskedFor) {
  const SonarSettings settings = settings_of(0.1);
  const EchoImage image = clutter_of(settings);
  const double volume_m3 = 120 * degree * 2 * std::sin(20 * degree) * std::pow(20, 3) / 3;
  const double expected = 0.1 * volume_m3;  // 382, with a standard deviation of some 17
  EXPECT_NEAR(static_cast<double>(count_of(image)), expected, 60);
  double strength = 0;
  for (int beam = 0; beam < image.beams; ++beam) {
    for (int line = 0; line < image.bins; ++line) {
      strength += static_cast<double>(image.at(beam, line)) * std::pow((line + 0.5) * 0.05, 2);
    }
  }
  EXPECT_NEAR(10 * std::log10(strength / static_cast<double>(count_of(image))), -45, 0.8);
}

TEST(WaterClutter, StaysWhereItIsInTheWorld) {
  const SonarSettings settings = settings_of(0.1);
  Pose turned;
  turned.orientation = glm::angleAxis(10 * degree, glm::dvec3(0, 0, 1));
  const EchoImage before = clutter_of(settings), after = clutter_of(settings, turned);
  int same = 0;
  for (int beam = 0; beam + 10 < 120; ++beam) {  // 10 degrees to port: 10 beams on
    for (int line = 0; line < 400; ++line) {
      same +=
          before.at(beam, line) > 0 && std::abs(after.at(beam + 10, line) / before.at(beam, line) - 1) < 1e-4
              ? 1
              : 0;
    }
  }
  EXPECT_GT(same, 200);
}

TEST(WaterClutter, IsHiddenBehindTheFirstEcho) {
  const EchoImage image = clutter_of(settings_of(0.1), {}, 1, 1.0F);
  for (int beam = 0; beam < image.beams; ++beam) {
    for (int line = 201; line < image.bins; ++line) {
      ASSERT_EQ(image.at(beam, line), 0) << beam << ' ' << line;
    }
  }
  EXPECT_GT(count_of(image), 120 + 10);
}

TEST(WaterClutter, AnotherSeedIsOtherWaterAndNoneIsNone) {
  EXPECT_NE(clutter_of(settings_of(0.1)).intensity, clutter_of(settings_of(0.1), {}, 2).intensity);
  EXPECT_EQ(clutter_of(settings_of(0.1)).intensity, clutter_of(settings_of(0.1)).intensity);
  EXPECT_EQ(count_of(clutter_of(settings_of(0))), 0);
}

// A faint bed does not stand out because of fish before it, wherever the pulse spreads their echo.
TEST(WaterClutter, DoesNotMakeSurfacesStandOut) {
  PingRequest request;
  request.settings = settings_of(0);
  request.settings.aperture.azimuth = Aperture::Azimuth::ideal;
  request.settings.physical.pulse.shape = PulseSettings::Shape::chirp;
  request.settings.physical.pulse.range_cell_m = 0.2;
  request.T_world_sonar.position_m = {0, 0, 4};
  const World bed =
      test::make_world({test::make_body("bed", test::make_quad({-60, -60, 0}, {120, 0, 0}, {0, 120, 0}))});
  const auto over_floor = [&](double density_per_m3) {
    request.settings.physical.water_clutter = {density_per_m3, -10};
    SonarRenderer renderer(bed, {EngineKind::cpu, 1});
    renderer.render_ping(request);
    return renderer.last_statistics().echo_over_floor;
  };
  const double without = over_floor(0);
  EXPECT_GT(without, 0);
  EXPECT_NEAR(over_floor(0.1) / without, 1, 0.3);
}

}  // namespace
}  // namespace sonard::render
