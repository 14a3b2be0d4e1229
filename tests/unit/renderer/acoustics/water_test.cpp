// SPDX-License-Identifier: Apache-2.0
// Absorption and speed of sound against the check tables of docs/physics.md 2.2 and published check values.
#include "renderer/acoustics/water.hpp"

#include <cmath>
#include <ostream>

#include <gtest/gtest.h>

namespace sonard::render {
namespace {

struct AbsorptionCase {
  double f_khz;
  Water water;
  double francois_garrison_db_per_km;
  double ainslie_mccolm_db_per_km;
};

std::ostream& operator<<(std::ostream& out, const AbsorptionCase& c) {
  return out << c.f_khz << " kHz, " << c.water.temperature_c << " degC, " << c.water.salinity_ppt << " ppt, "
             << c.water.depth_m << " m, pH " << c.water.ph;
}

double relaxation(double relaxation_khz, double f_khz) {
  const double f2 = f_khz * f_khz;
  return relaxation_khz <= 0.0 ? 0.0 : relaxation_khz * f2 / (relaxation_khz * relaxation_khz + f2);
}

/// Ainslie & McColm (1998): an independent formula.
double ainslie_mccolm_db_per_km(double f, const Water& water) {
  const double t = water.temperature_c;
  const double s = water.salinity_ppt;
  const double depth_km = water.depth_m / 1000.0;
  const double boric_khz = 0.78 * std::sqrt(s / 35.0) * std::exp(t / 26.0);
  const double magnesium_khz = 42.0 * std::exp(t / 17.0);
  return 0.106 * relaxation(boric_khz, f) * std::exp((water.ph - 8.0) / 0.56) +
         0.52 * (1.0 + t / 43.0) * (s / 35.0) * relaxation(magnesium_khz, f) * std::exp(-depth_km / 6.0) +
         0.00049 * f * f * std::exp(-(t / 27.0 + depth_km / 17.0));
}

class Absorption : public testing::TestWithParam<AbsorptionCase> {};

TEST_P(Absorption, FrancoisGarrisonMeetsTheTable) {
  const AbsorptionCase& c = GetParam();
  // The table has five or six digits.
  EXPECT_NEAR(francois_garrison_absorption_db_per_m(c.f_khz * 1e3, c.water) * 1e3,
              c.francois_garrison_db_per_km, 2e-5 * c.francois_garrison_db_per_km);
}

TEST_P(Absorption, LiesWithinATenthOfASecondOpinion) {
  const AbsorptionCase& c = GetParam();
  const double other = ainslie_mccolm_db_per_km(c.f_khz, c.water);
  EXPECT_NEAR(other, c.ainslie_mccolm_db_per_km, 2e-5 * other);
  EXPECT_NEAR(francois_garrison_absorption_db_per_m(c.f_khz * 1e3, c.water) * 1e3, other, 0.1 * other);
}

INSTANTIATE_TEST_SUITE_P(Table, Absorption,
                         testing::Values(AbsorptionCase{720, {10, 35, 10, 8.0}, 208.513, 223.278},
                                         AbsorptionCase{720, {20, 35, 10, 8.0}, 208.748, 221.227},
                                         AbsorptionCase{720, {4, 35, 10, 8.0}, 239.187, 248.997},
                                         AbsorptionCase{720, {10, 0, 5, 7.0}, 161.088, 175.341},
                                         AbsorptionCase{720, {26, 37, 8, 8.1}, 239.959, 256.429},
                                         AbsorptionCase{700, {10, 35, 10, 8.0}, 199.659, 213.645},
                                         AbsorptionCase{750, {10, 35, 10, 8.0}, 222.255, 238.231},
                                         AbsorptionCase{1200, {10, 35, 10, 8.0}, 495.172, 535.240},
                                         AbsorptionCase{2100, {10, 35, 10, 8.0}, 1418.02, 1539.63},
                                         AbsorptionCase{100, {10, 35, 0, 8.0}, 33.630, 34.341}));

TEST(Absorption, FrancoisGarrisonMeetsThePublicToolboxValue) {
  EXPECT_NEAR(francois_garrison_absorption_db_per_m(50e3, {27, 35, 10, 8.1}) * 1e3, 10.710, 5e-4);
}

TEST(Absorption, AcidityHardlyMattersAtSonarFrequencies) {
  const double acid = francois_garrison_absorption_db_per_m(720e3, {10, 35, 10, 7.7});
  const double alkaline = francois_garrison_absorption_db_per_m(720e3, {10, 35, 10, 8.2});
  EXPECT_GT(alkaline, acid);
  EXPECT_LT((alkaline - acid) * 1e3, 0.2);
}

TEST(Absorption, IsFiniteAndNotNegativeFarOutsideTheStatedRange) {
  for (const double f : {0.0, 1.0, 1e3, 1e6, 1e7}) {
    for (const double t : {-2.0, 0.0, 20.0, 20.001, 40.0}) {
      for (const double s : {0.0, 1e-9, 35.0, 45.0}) {
        for (const double d : {0.0, 11000.0}) {
          const Water water{t, s, d, 8.0};
          const double fg = francois_garrison_absorption_db_per_m(f, water);
          EXPECT_TRUE(std::isfinite(fg) && fg >= 0.0)
              << f << " Hz " << t << " C " << s << " ppt " << d << " m";
        }
      }
    }
  }
}

TEST(Absorption, KnowsWhereTheFormulaWasStated) {
  EXPECT_TRUE(in_absorption_range(723380, {10, 35, 10, 8}));
  EXPECT_FALSE(in_absorption_range(1.2e6, {10, 35, 10, 8}));
  EXPECT_FALSE(in_absorption_range(723380, {31, 35, 10, 8}));
  EXPECT_FALSE(in_absorption_range(723380, {10, 0, 10, 8}));
}

TEST(SoundSpeed, MackenzieMeetsItsPublishedCheckValue) {
  EXPECT_NEAR(mackenzie_sound_speed_mps({25, 35, 1000, 8}), 1550.744, 5e-4);
}

TEST(SoundSpeed, BothFormulasMeetTheTable) {
  EXPECT_NEAR(mackenzie_sound_speed_mps({10, 35, 10, 8}), 1489.97, 5e-3);
  EXPECT_NEAR(medwin_sound_speed_mps({10, 35, 10, 8}), 1490.15, 5e-3);
}

TEST(SoundSpeed, TakesMackenzieInItsRangeAndMedwinOutside) {
  const Water sea{10, 35, 10, 8};
  const Water lake{10, 0, 10, 7};
  const Water polar{-1, 34, 10, 8};
  EXPECT_EQ(sound_speed_mps(sea), mackenzie_sound_speed_mps(sea));
  EXPECT_EQ(sound_speed_mps(lake), medwin_sound_speed_mps(lake));
  EXPECT_EQ(sound_speed_mps(polar), medwin_sound_speed_mps(polar));
  // Fresh water at 10 degC: 1447.3 m/s (Del Grosso & Mader 1972).
  EXPECT_NEAR(sound_speed_mps({10, 0, 0, 7}), 1447.3, 1.5);
}

}  // namespace
}  // namespace sonard::render
