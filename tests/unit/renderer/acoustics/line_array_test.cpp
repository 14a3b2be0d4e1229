// SPDX-License-Identifier: Apache-2.0
// The receive array against the table of docs/physics.md 2.5, and sums of its elements written out here.
#include "renderer/acoustics/line_array.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace sonard::render {
namespace {

using Taper = Aperture::Taper;

struct TaperFacts {
  Taper taper;
  double beamwidth_deg;  ///< of 101 half-wave elements
  double side_lobe_db;
};

constexpr std::array table{TaperFacts{Taper::uniform, 1.006, -13.3}, TaperFacts{Taper::kaiser, 1.19, -21.1},
                           TaperFacts{Taper::hann, 1.65, -31.5}, TaperFacts{Taper::hamming, 1.49, -42.6}};

double power_db(const std::vector<double>& weights, double sine_offset) {
  double re = 0;
  double im = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    re += weights[i] * std::cos(std::numbers::pi * static_cast<double>(i) * sine_offset);
    im += weights[i] * std::sin(std::numbers::pi * static_cast<double>(i) * sine_offset);
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  return 10 * std::log10((re * re + im * im) / (sum * sum) + 1e-30);
}

TEST(LineArray, TapersHaveTheWidthsAndSideLobesOfTheTable) {
  for (const TaperFacts& facts : table) {
    const std::vector<double> weights = taper_weights(facts.taper, 101);
    double edge = 0;
    while (power_db(weights, edge) > 10 * std::log10(0.5)) {
      edge += 1e-5;
    }
    EXPECT_NEAR(2 * std::asin(edge) * 180 / std::numbers::pi, facts.beamwidth_deg, 0.006);
    // Behind the first minimum.
    double offset = edge;
    while (power_db(weights, offset + 1e-4) < power_db(weights, offset)) {
      offset += 1e-4;
    }
    double highest = -200;
    for (; offset < 1; offset += 1e-4) {
      highest = std::max(highest, power_db(weights, offset));
    }
    EXPECT_NEAR(highest, facts.side_lobe_db, 0.1);
  }
}

TEST(LineArray, HasTheBeamwidthAskedFor) {
  for (const TaperFacts& facts : table) {
    for (const double degrees : {0.5, 1.0, 3.0}) {
      Aperture aperture;
      aperture.taper = facts.taper;
      aperture.receive_beamwidth_rad = degrees * std::numbers::pi / 180;
      const LineArray array(aperture);
      const double at_edge = array.power(std::sin(aperture.receive_beamwidth_rad / 2));
      EXPECT_NEAR(at_edge, 0.5, 0.035) << degrees;
      EXPECT_NEAR(10 * std::log10(array.power(0.7 / array.elements())),
                  power_db(taper_weights(facts.taper, array.elements()), 0.7 / array.elements()), 1e-9);
      EXPECT_EQ(array.mean_error_power(), 0);
    }
  }
}

// 155 half-wave elements under a Hamming taper: sum w^2 / (sum w)^2 is about 1.3628 / 154.5.
TEST(LineArray, ErrorsOfTheElementsLeaveAFloor) {
  Aperture aperture;
  aperture.element_amplitude_sd = 0.3;
  aperture.element_phase_sd_rad = 0.4;
  double sum = 0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const LineArray array(aperture, make_random_key(seed, 0, RandomField::array_elements, 0));
    const double noise = 1 + 0.3 * 0.3 - std::exp(-0.4 * 0.4);
    EXPECT_NEAR(array.mean_error_power(), noise * 1.3628 / 154.5, 1e-5);
    for (double offset = 0.1; offset < 1; offset += 2.0 / 155) {
      sum += array.power(offset) / array.mean_error_power();
      ++count;
    }
  }
  // Power of a complex Gaussian: the mean of n has the standard deviation 1 / sqrt(n).
  EXPECT_NEAR(sum / count, 1, 4 / std::sqrt(count));
  EXPECT_GT(count, 4000);
}

TEST(LineArray, ErrorsBelongToTheirKeyAlone) {
  Aperture aperture;
  aperture.element_phase_sd_rad = 0.4;
  const RandomKey key = make_random_key(1, 2, RandomField::array_elements, 0);
  EXPECT_EQ(LineArray(aperture, key).power(0.2), LineArray(aperture, key).power(0.2));
  EXPECT_NE(LineArray(aperture, key).power(0.2),
            LineArray(aperture, make_random_key(1, 3, RandomField::array_elements, 0)).power(0.2));
}

}  // namespace
}  // namespace sonard::render
