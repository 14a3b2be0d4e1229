// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/materials.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sonard::render {
namespace {

using testing::HasSubstr;

double level_db(double linear) {
  return 10.0 * std::log10(linear);
}

std::string material_error(const MaterialRequest& request) {
  std::vector<std::string> warnings;
  try {
    make_acoustic_material(request, warnings);
  } catch (const WorldError& error) {
    return error.what();
  }
  return "";
}

// The table of docs/physics.md 2.4. Its R of rock and gravel is a span with gravel and rock at its ends, its
// R of wood a span with this value in the middle. Its sigma of rock and gravel is "> 5".
TEST(MaterialTable, HoldsTheBackscatterTable) {
  struct Row {
    std::string name;
    double R, mu_db, m, sigma_mm;
  };
  const std::vector<Row> expected{
      {"steel", .94, -25, .05, .1},  {"steel_fouled", .9, -15, .3, 2}, {"aluminium", .84, -25, .05, .1},
      {"concrete", .68, -18, .2, 1}, {"pvc", .36, -28, .05, .1},       {"gravel", .6, -15, .4, 5},
      {"rock", .83, -15, .4, 10},    {"sand", .38, -22, .2, 2},        {"mud", .06, -32, .1, 1},
      {"wood", .065, -28, .2, .5},   {"rubber", .09, -32, .1, .3},     {"air", -1.0, -20, .05, .1}};
  for (const Row& row : expected) {
    const auto material = find_acoustic_material(row.name);
    ASSERT_TRUE(material) << row.name;
    EXPECT_NEAR(material->pressure_reflection, row.R, 1e-12) << row.name;
    EXPECT_NEAR(level_db(material->lambert_mu), row.mu_db, 1e-9) << row.name;
    EXPECT_NEAR(material->rms_slope, row.m, 1e-12) << row.name;
    EXPECT_NEAR(material->rms_height_m, row.sigma_mm / 1000, 1e-12) << row.name;
    EXPECT_NEAR(material->reflectance, 2.12 / 0.94 * std::abs(row.R), 0.0051) << row.name;
  }
}

// Cox & Munk (1954), clean surface: mean square slope of both axes 0.003 + 5.12e-3 U. Pierson & Moskowitz
// (1964): significant height 0.21 U^2 / g, four times the rms height. U = 5 m/s.
TEST(MaterialTable, TheSeaSurfaceIsThatOfALightBreeze) {
  const AcousticMaterial sea = find_acoustic_material("sea_surface").value();
  EXPECT_EQ(sea.pressure_reflection, -1.0);
  EXPECT_NEAR(sea.rms_slope, std::sqrt((0.003 + 5.12e-3 * 5) / 2), 0.005);
  EXPECT_NEAR(sea.rms_height_m, 0.21 * 25 / 9.81 / 4, 0.005);
}

TEST(MaterialTable, HasOtherNamesForSome) {
  EXPECT_EQ(find_acoustic_material("aluminum").value().name, "aluminium");
  EXPECT_EQ(find_acoustic_material("Steel_Clean.002").value().name, "steel");
  EXPECT_EQ(find_acoustic_material("water_surface").value().name, "air");
}

TEST(MaterialTable, EveryRowIsPassive) {
  for (const std::string& name : acoustic_material_names()) {
    const AcousticMaterial material = find_acoustic_material(name).value();
    EXPECT_LE(material.lambert_mu, std::numbers::inv_pi) << name;
    EXPECT_EQ(material.name, name);
  }
}

TEST(MaterialTable, TheDefaultIsTheDefault) {
  const AcousticMaterial named = find_acoustic_material("default").value();
  EXPECT_EQ(named.reflectance, AcousticMaterial{}.reflectance);
  EXPECT_NEAR(named.lambert_mu, AcousticMaterial{}.lambert_mu, 2e-5);
  EXPECT_EQ(named.pressure_reflection, 0.0);
  EXPECT_EQ(named.pressure_reflection, AcousticMaterial{}.pressure_reflection);
  EXPECT_EQ(named.rms_slope, AcousticMaterial{}.rms_slope);
  EXPECT_EQ(named.rms_height_m, AcousticMaterial{}.rms_height_m);
}

TEST(MaterialTable, IgnoresCaseAndTheSuffixesOfModellingTools) {
  EXPECT_EQ(find_acoustic_material("Steel.001").value().name, "steel");
  EXPECT_EQ(find_acoustic_material("SAND").value().name, "sand");
  EXPECT_FALSE(find_acoustic_material("steel.x"));
  EXPECT_FALSE(find_acoustic_material(""));
}

TEST(MaterialRequest, ReplacesSingleNumbersOfANamedMaterial) {
  std::vector<std::string> warnings;
  const AcousticMaterial material = make_acoustic_material({"steel", 1.4, std::nullopt}, warnings);
  EXPECT_EQ(material.reflectance, 1.4);
  EXPECT_NEAR(level_db(material.lambert_mu), -25.0, 1e-9);
  EXPECT_TRUE(warnings.empty());
}

TEST(MaterialRequest, ReplacesTheNumbersOfFacets) {
  std::vector<std::string> warnings;
  MaterialRequest request;
  request.name = "concrete";
  request.rms_slope = 0.1;
  AcousticMaterial material = make_acoustic_material(request, warnings);
  EXPECT_EQ(material.rms_slope, 0.1);
  EXPECT_EQ(material.pressure_reflection, 0.68);
  EXPECT_NEAR(material.rms_height_m, 0.001, 1e-12);
  request.pressure_reflection = -0.5;
  request.rms_height_mm = 0.0;
  material = make_acoustic_material(request, warnings);
  EXPECT_EQ(material.pressure_reflection, -0.5);
  EXPECT_EQ(material.rms_height_m, 0.0);
  EXPECT_NEAR(level_db(material.lambert_mu), -18.0, 1e-9);
  EXPECT_TRUE(warnings.empty());
}

TEST(MaterialRequest, ChecksTheNumbersOfFacets) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double wrong : {-1.01, 1.01, nan}) {
    EXPECT_THAT(material_error({"", {}, {}, wrong, {}, {}}), HasSubstr("pressure_reflection is"));
  }
  for (const double wrong : {0.0, 0.009, 0.51, nan}) {
    EXPECT_THAT(material_error({"", {}, {}, {}, wrong, {}}), HasSubstr("rms_slope is"));
  }
  for (const double wrong : {-0.1, 1000.1, nan}) {
    EXPECT_THAT(material_error({"", {}, {}, {}, {}, wrong}), HasSubstr("rms_height_mm is"));
  }
}

TEST(MaterialRequest, MayDefineANewOne) {
  std::vector<std::string> warnings;
  const AcousticMaterial material = make_acoustic_material({"hull_paint", 1.2, -20.0}, warnings);
  EXPECT_EQ(material.name, "hull_paint");
  EXPECT_EQ(material.pressure_reflection, 0.0);
  EXPECT_NEAR(material.lambert_mu, 0.01, 1e-12);
}

TEST(MaterialRequest, UnknownNamesGetAHint) {
  EXPECT_THAT(material_error({"stel", {}, {}}), HasSubstr("did you mean 'steel'"));
  EXPECT_THAT(material_error({"concreet", {}, {}}), HasSubstr("did you mean 'concrete'"));
  EXPECT_THAT(material_error({"kryptonite", 1.0, {}}), HasSubstr("known: default, steel"));
  EXPECT_THAT(material_error({"kryptonite", {}, {}}), testing::Not(HasSubstr("did you mean")));
}

TEST(MaterialRequest, ChecksItsNumbers) {
  EXPECT_THAT(material_error({"", -0.1, {}}), HasSubstr("reflectance is -0.1"));
  EXPECT_THAT(material_error({"", std::numeric_limits<double>::quiet_NaN(), {}}), HasSubstr("reflectance"));
  EXPECT_THAT(material_error({"", {}, std::numeric_limits<double>::infinity()}), HasSubstr("lambert_mu_db"));
  std::vector<std::string> warnings;
  EXPECT_EQ(make_acoustic_material({"", 1e6, -22.0}, warnings).reflectance, 1e6);
  EXPECT_EQ(warnings.size(), 1U);
  EXPECT_EQ(make_acoustic_material({"", {}, 0.0}, warnings).lambert_mu, std::numbers::inv_pi);
  EXPECT_EQ(warnings.size(), 2U);
}

TEST(LaserRetro, SetsBothModels) {
  std::vector<std::string> warnings;
  const AcousticMaterial reference = material_of_laser_retro(0.35, warnings);
  EXPECT_EQ(reference.reflectance, 0.35);
  EXPECT_NEAR(level_db(reference.lambert_mu), -22.0, 1e-9);
  // Twice the amplitude, 6.02 dB.
  EXPECT_NEAR(level_db(material_of_laser_retro(0.7, warnings).lambert_mu), -15.9794, 1e-3);
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(material_of_laser_retro(100.0, warnings).lambert_mu, std::numbers::inv_pi);
  EXPECT_FALSE(warnings.empty());
  EXPECT_EQ(material_of_laser_retro(0.0, warnings).name, "default");
  EXPECT_THROW(material_of_laser_retro(-1.0, warnings), WorldError);
}

}  // namespace
}  // namespace sonard::render
