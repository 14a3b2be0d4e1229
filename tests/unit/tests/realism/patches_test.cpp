// SPDX-License-Identifier: Apache-2.0
// The estimator of spikiness on images whose distribution has a closed form: Rayleigh amplitudes have
// a coefficient of variation of sqrt(4 / pi - 1) = 0.5227 and an intensity index of 1; K distributed ones an
// index of 1 + 2 / nu.
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/realism/patches.hpp"

namespace sonard::realism {
namespace {

/// One patch for each beam column, 60 rows of patches.
AmplitudeImage image_of(const std::function<double(int line, int beam)>& amplitude, int columns = 6) {
  AmplitudeImage image{60 * patch_lines, columns * patch_beams, 1e9, {}};
  for (int line = 0; line < image.lines; ++line) {
    for (int beam = 0; beam < image.beams; ++beam) {
      image.amplitude.push_back(amplitude(line, beam));
    }
  }
  return image;
}

/// |z| of complex Gaussian numbers, with intensities of mean 1 from a Gamma distribution. @param nu 0:
/// Rayleigh
std::function<double(int, int)> speckle(double nu = 0) {
  return [random = std::mt19937(5), nu](int, int) mutable {
    const double intensity = std::exponential_distribution<double>(1)(random);
    return std::sqrt(nu > 0 ? intensity * std::gamma_distribution<double>(nu, 1 / nu)(random) : intensity);
  };
}

double k_variation(double nu) {
  const double mean = std::sqrt(std::numbers::pi / nu) / 2 * std::tgamma(nu + 0.5) / std::tgamma(nu);
  return std::sqrt(1 / (mean * mean) - 1);
}

TEST(HomogeneousPatches, RayleighEchoesHaveAnIndexOfOne) {
  const std::vector<Patch> patches = homogeneous_patches(image_of(speckle()));
  EXPECT_EQ(patches.size(), 360u);
  for (const Third third : {Third::dark, Third::middle, Third::bright}) {
    EXPECT_NEAR(median_of(patches, third).variation, std::sqrt(4 / std::numbers::pi - 1), 0.015);
    EXPECT_NEAR(median_of(patches, third).index, 1, 0.06);
  }
}

// The median of the index of 640 samples is a little below its mean, and more so for a heavier tail.
TEST(HomogeneousPatches, KDistributedEchoesHaveOnePlusTwoOverNu) {
  for (const double nu : {2.0, 4.0, 10.0}) {
    const std::vector<Patch> patches = homogeneous_patches(image_of(speckle(nu)));
    EXPECT_GT(patches.size(), 350u) << nu;
    EXPECT_NEAR(median_of(patches, Third::middle).variation, k_variation(nu), 0.02) << nu;
    EXPECT_NEAR(median_of(patches, Third::middle).index / (1 + 2 / nu), 0.97, 0.06) << nu;
  }
}

TEST(HomogeneousPatches, ASlopeIsNotPicked) {
  const auto sloping = [](double change) {
    return [z = speckle(), change](int line, int beam) mutable {
      return z(line, beam) * (1 + change * ((beam % patch_beams) / (patch_beams - 1.0) - 0.5));
    };
  };
  // A quadrant mean differs by a quarter of the change across the patch; the standard deviation is 0.52 or
  // more.
  EXPECT_EQ(homogeneous_patches(image_of(sloping(1.9))).size(), 0u);
  const std::vector<Patch> gentle = homogeneous_patches(image_of(sloping(0.2)));
  EXPECT_EQ(gentle.size(), 360u);
  EXPECT_NEAR(median_of(gentle, Third::middle).variation, std::sqrt(4 / std::numbers::pi - 1), 0.02);
}

// Halves with a mean of 3 and 1: off by 1. A plane leaves a quarter of the variance 1 of such a step, and
// speckle has 0.273 (9 + 1) / 2, so that 0.6 standard deviations are 0.76.
TEST(HomogeneousPatches, AnEdgeIsNotPicked) {
  for (const bool across_lines : {true, false}) {
    const std::vector<Patch> patches =
        homogeneous_patches(image_of([z = speckle(), across_lines](int line, int beam) mutable {
          const bool bright = across_lines ? line % patch_lines < patch_lines / 2 : beam % patch_beams < 20;
          return z(line, beam) * (bright ? 3 : 1);
        }));
    EXPECT_EQ(patches.size(), 0u) << across_lines;
  }
}

TEST(HomogeneousPatches, OneQuadrantInAShadowIsNotPicked) {
  const std::vector<Patch> patches =
      homogeneous_patches(image_of([z = speckle()](int line, int beam) mutable {
        return z(line, beam) * (line % patch_lines < patch_lines / 2 && beam % patch_beams < 20 ? 0.1 : 1);
      }));
  EXPECT_EQ(patches.size(), 0u);
}

// 640 samples of a patch: 12 of them are 1.9 %, 13 of them 2.03 %.
TEST(HomogeneousPatches, ClippedPatchesAreNotPicked) {
  for (const double code : {0.0, 5.0}) {
    const auto with = [&](int clipped) {
      AmplitudeImage image = image_of([](int line, int beam) { return 1 + 0.01 * ((line + beam) % 2); }, 1);
      image.full_scale = 5;
      for (int line = 0; line < image.lines; ++line) {
        for (int beam = 0; beam < patch_beams; ++beam) {
          // Spread over the patch, so that all quadrants have a share.
          const int place = (line % patch_lines * patch_beams + beam) * 49 % 640;
          if (place < clipped) {
            image.amplitude[static_cast<std::size_t>(line * patch_beams + beam)] = code;
          }
        }
      }
      return homogeneous_patches(image).size();
    };
    EXPECT_EQ(with(12), 60u) << code;
    EXPECT_EQ(with(13), 0u) << code;
  }
}

TEST(HomogeneousPatches, ThirdsGoByBrightness) {
  const std::vector<Patch> patches = homogeneous_patches(image_of(
      [rayleigh = speckle(), k = speckle(1)](int line, int beam) mutable {
        const int column = beam / patch_beams;
        return column == 0 ? k(line, beam) : column * 4 * rayleigh(line, beam);
      },
      3));
  EXPECT_NEAR(median_of(patches, Third::dark).variation, k_variation(1), 0.03);
  EXPECT_NEAR(median_of(patches, Third::bright).variation, std::sqrt(4 / std::numbers::pi - 1), 0.02);
  EXPECT_NEAR(median_of(patches, Third::bright).mean, 8 * std::sqrt(std::numbers::pi) / 2, 0.3);
}

TEST(HomogeneousPatches, WithoutThreePatchesThereIsNoMedian) {
  EXPECT_TRUE(std::isnan(median_of({{1, 2, 3}, {1, 2, 3}}, Third::middle).index));
}

}  // namespace
}  // namespace sonard::realism
