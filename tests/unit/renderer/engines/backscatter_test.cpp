// SPDX-License-Identifier: Apache-2.0
#include "renderer/surface/backscatter.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "renderer/scene/materials.hpp"
#include "tests/support/closed_forms.hpp"

namespace sonard::render {
namespace {

AcousticMaterial material(double R, double m, double mu) {
  AcousticMaterial material;
  material.pressure_reflection = R;
  material.rms_slope = m;
  material.lambert_mu = mu;
  return material;
}

// s_b / cos phi of docs/physics.md 2.4.
TEST(Backscatter, FollowsTheLaw) {
  for (const double m : {0.01, 0.05, 0.2, 0.5}) {
    const Backscatter backscatter(material(-0.9, m, 0.01));
    const test::FacetLaw law{0.9, m, 0.01};
    for (const double tangent_by_m : {0.0, 0.5, 1.0, 2.0, 4.0}) {
      const double cosine = std::cos(std::atan(tangent_by_m * m));
      const double expected = law.strength(cosine) / cosine;
      EXPECT_NEAR(
          static_cast<double>(backscatter.at(static_cast<float>(cosine), Facets::everywhere)) / expected, 1.0,
          m < 0.02 ? 5e-3 : 5e-4)
          << m << ' ' << tangent_by_m;
      EXPECT_LE(expected, static_cast<double>(backscatter.largest_response()) * 1.0001);
    }
    EXPECT_FLOAT_EQ(backscatter.at(0.8F, Facets::none), 0.008F);
  }
}

TEST(Backscatter, IsFiniteAtEveryIncidence) {
  for (const double m : {0.01, 0.5}) {
    const Backscatter backscatter(material(1, m, 0.0));
    for (const float cosine : {0.0F, 1e-38F, 1e-20F, 1e-6F, 1e-3F, 0.5F, 1.0F}) {
      const float echo = backscatter.at(cosine, Facets::everywhere);
      EXPECT_TRUE(std::isfinite(echo) && echo >= 0 && echo <= backscatter.largest_response()) << cosine;
    }
  }
}

// Omitted facets are below a thousandth of the Lambert part, for every named material.
TEST(Backscatter, LeavesOutWhatIsNegligible) {
  for (const std::string& name : acoustic_material_names()) {
    const Backscatter backscatter(find_acoustic_material(name).value());
    float left_out = 0;
    for (int i = 1; i <= 10000; ++i) {
      const float cosine = static_cast<float>(i) / 10000;
      if (!backscatter.has_facets(Facets::near_normal, cosine)) {
        left_out = std::max(left_out, backscatter.facets(cosine) / backscatter.lambert(cosine));
      }
    }
    EXPECT_LE(left_out, 1.01e-3F) << name;
    EXPECT_EQ(backscatter.has_facets(Facets::near_normal, 1.0F), name != "default") << name;
  }
  // docs/skipping.md gives 4 atan m; there the facets of clean steel are still stronger than the rest.
  const Backscatter steel(find_acoustic_material("steel").value());
  const float at_4m = std::cos(4 * std::atan(0.05F));
  EXPECT_GT(steel.facets(at_4m), steel.lambert(at_4m));
  EXPECT_LT(std::acos(steel.least_cosine), 16.0F * std::numbers::pi_v<float> / 180);
}

TEST(Backscatter, WithoutLambertNothingIsNegligible) {
  EXPECT_TRUE(Backscatter(material(0.9, 0.05, 0.0)).has_facets(Facets::near_normal, 0.01F));
  EXPECT_FALSE(Backscatter(material(0.0, 0.05, 0.1)).has_facets(Facets::near_normal, 1.0F));
}

// Slopes (x, y) Gaussian with variance v each: the mean of (x, y, 1) / sqrt(1 + x^2 + y^2) has the length
// integral of exp(-s) / sqrt(1 + 2 v s) ds.
TEST(Backscatter, MeanNormalsTellTheirVariance) {
  for (const double v : {0.001, 0.01, 0.04}) {
    double length = 0;
    for (int i = 0; i < 40000; ++i) {
      const double s = (i + 0.5) * 1e-3;
      length += std::exp(-s) / std::sqrt(1 + 2 * v * s) * 1e-3;
    }
    EXPECT_NEAR(static_cast<double>(variance_of_mean_normal(static_cast<float>(length))) / v, 1.0,
                2.5 * v + 2e-3)
        << v;
  }
  EXPECT_EQ(variance_of_mean_normal(1.0F), 0.0F);
  EXPECT_EQ(variance_of_mean_normal(1.0001F), 0.0F);
  EXPECT_TRUE(std::isfinite(variance_of_mean_normal(0.0F)));
}

}  // namespace
}  // namespace sonard::render
