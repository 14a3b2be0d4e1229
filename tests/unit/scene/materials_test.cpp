#include "renderer/scene/materials.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sonard::render {
namespace {

using testing::HasSubstr;

double level_db(double linear) {
  return 10.0 * std::log10(linear);
}

std::string error_of(const MaterialRequest& request) {
  std::vector<std::string> warnings;
  try {
    make_acoustic_material(request, warnings);
  } catch (const WorldError& error) {
    return error.what();
  }
  return "";
}

// docs/physics.md 2.4, column "mu dB".
TEST(MaterialTable, HoldsTheLambertCoefficients) {
  const std::vector<std::pair<std::string, double>> expected{
      {"steel", -25}, {"steel_fouled", -15}, {"aluminium", -25}, {"concrete", -18},
      {"pvc", -28},   {"gravel", -15},       {"rock", -15},      {"sand", -22},
      {"mud", -32},   {"wood", -28},         {"rubber", -32},    {"air", -20}};
  for (const auto& [name, mu_db] : expected) {
    const auto material = find_acoustic_material(name);
    ASSERT_TRUE(material) << name;
    EXPECT_NEAR(level_db(material->lambert_mu), mu_db, 1e-9) << name;
    EXPECT_GT(material->reflectance, 0.0) << name;
  }
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

TEST(MaterialRequest, MayDefineANewOne) {
  std::vector<std::string> warnings;
  const AcousticMaterial material = make_acoustic_material({"hull_paint", 1.2, -20.0}, warnings);
  EXPECT_EQ(material.name, "hull_paint");
  EXPECT_NEAR(material.lambert_mu, 0.01, 1e-12);
}

TEST(MaterialRequest, UnknownNamesGetAHint) {
  EXPECT_THAT(error_of({"stel", {}, {}}), HasSubstr("did you mean 'steel'"));
  EXPECT_THAT(error_of({"concreet", {}, {}}), HasSubstr("did you mean 'concrete'"));
  EXPECT_THAT(error_of({"kryptonite", 1.0, {}}), HasSubstr("known: default, steel"));
  EXPECT_THAT(error_of({"kryptonite", {}, {}}), testing::Not(HasSubstr("did you mean")));
}

TEST(MaterialRequest, ChecksItsNumbers) {
  EXPECT_THAT(error_of({"", -0.1, {}}), HasSubstr("reflectance is -0.1"));
  EXPECT_THAT(error_of({"", std::numeric_limits<double>::quiet_NaN(), {}}), HasSubstr("reflectance"));
  EXPECT_THAT(error_of({"", {}, std::numeric_limits<double>::infinity()}), HasSubstr("lambert_mu_db"));
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
