// SPDX-License-Identifier: Apache-2.0
#include "renderer/multipath/mirror_law.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "renderer/multipath/path_fan.hpp"
#include "tests/support/degree.hpp"

namespace sonard::render {
namespace {

constexpr double wavelength_m = 1500.0 / 720e3;

double level_db(double rms_height_mm, double grazing_deg) {
  return 10 *
         std::log10(Mirror(1.0, rms_height_mm / 1000).gain(std::sin(grazing_deg * degree), wavelength_m));
}

// The numbers of docs/physics.md 2.11, as printed there.
TEST(MirrorLaw, RoughnessWeakensTheImageAsTabulated) {
  EXPECT_NEAR(level_db(1, 5), -1.2, 0.05);
  EXPECT_NEAR(level_db(1, 30), -39.5, 0.05);
  EXPECT_NEAR(level_db(0.3, 5), -0.1, 0.05);
  EXPECT_NEAR(level_db(0.3, 30), -3.6, 0.05);
  EXPECT_NEAR(level_db(0.3, 90), -14, 0.3);
  EXPECT_NEAR(level_db(3, 5), -11, 0.3);
}

TEST(MirrorLaw, ReflectionEntersSquaredAndKeepsItsSignInPressure) {
  const Mirror air(-1.0, 0.0), concrete(0.68, 0.0);
  EXPECT_EQ(air.gain(0.5, wavelength_m), 1.0);
  EXPECT_EQ(air.pressure(0.5, wavelength_m), -1.0);
  EXPECT_NEAR(concrete.gain(0.5, wavelength_m), 0.4624, 1e-12);
  EXPECT_NEAR(concrete.pressure(0.5, wavelength_m), 0.68, 1e-12);
}

TEST(PathFan, CellsFillTheFanOnce) {
  Aperture aperture;
  aperture.beam_edges_rad = equal_sine_edges(128, 60 * degree);
  const PathFan fan(aperture);
  double solid_angle = 0.0;
  for (int column = 0; column < fan.columns(); ++column) {
    for (int row = 0; row < fan.rows(); ++row) {
      const FanCell cell = fan.cell(column, row);
      EXPECT_EQ(fan.beam_of(cell.azimuth_rad), cell.beam);
      EXPECT_LE(cell.width_rad, 0.2501 * degree);
      solid_angle += cell.solid_angle();
    }
  }
  EXPECT_NEAR(solid_angle, 120 * degree * 2 * std::sin(10 * degree), 1e-9);
  const FanCell cell = fan.cell(7, 11);
  double parts = 0.0;
  for (int i = 0; i < 16; ++i) {
    parts += cell.part(i % 4, i / 4, 4, 4).solid_angle();
  }
  EXPECT_NEAR(parts, cell.solid_angle(), 1e-15);
}

TEST(PathFan, RowsAreTwiceAsHighWhereLittleIsHeard) {
  Aperture aperture;
  aperture.beam_edges_rad = {0.001, -0.001};
  aperture.elevation = Aperture::Elevation::sinc;
  const PathFan fan(aperture);
  double height = 0.0;
  for (int row = 0; row < fan.rows(); ++row) {
    const FanCell cell = fan.cell(0, row);
    EXPECT_NEAR(cell.elevation_rad, -aperture.elevation_limit_rad() + height + cell.height_rad / 2, 1e-12);
    EXPECT_LE(cell.height_rad,
              (aperture.elevation_weight(cell.elevation_rad) > 0.26 ? 0.1601 : 0.3201) * degree);
    height += cell.height_rad;
  }
  EXPECT_NEAR(height, 2 * aperture.elevation_limit_rad(), 1e-12);
}

TEST(PathFan, BeamsAreFoundByTheirEdges) {
  Aperture aperture;
  aperture.beam_edges_rad = {0.3, 0.1, -0.2};
  const PathFan fan(aperture);
  EXPECT_EQ(fan.beam_of(0.31), std::nullopt);
  EXPECT_EQ(fan.beam_of(0.3), 0);
  EXPECT_EQ(fan.beam_of(0.2), 0);
  EXPECT_EQ(fan.beam_of(0.0), 1);
  EXPECT_EQ(fan.beam_of(-0.2), 1);
  EXPECT_EQ(fan.beam_of(-0.21), std::nullopt);
  EXPECT_TRUE(fan.contains({1, 0, 0.17}));
  EXPECT_FALSE(fan.contains({1, 0, 0.18}));
  EXPECT_FALSE(fan.contains({-1, 0, 0}));
}

}  // namespace
}  // namespace sonard::render
