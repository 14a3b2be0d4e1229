// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/image_error.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace sonard::bench {
namespace {

render::EchoImage image_of(int beams, std::vector<float> values) {
  const int lines = static_cast<int>(values.size()) / beams;
  return {beams, lines, std::move(values)};
}

TEST(ImageError, IsZeroForTheReferenceItself) {
  const render::EchoImage image = image_of(2, {0, 1, 2, 3, 0, 0, 5, 1});
  const auto error = compare_images(image, image);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->bin_rms, 0);
  EXPECT_EQ(error->bin_rms_trim, 0);
  EXPECT_EQ(error->first_echo_bins, 0);
  EXPECT_EQ(error->hole_fraction, 0);
  EXPECT_EQ(error->hole_fraction_60db, 0);
  EXPECT_EQ(error->beam_total_worst, 0);
  EXPECT_EQ(error->bins, 5U);
}

TEST(ImageError, PoolsLoudBinsOfAllBeams) {
  // Loud bins are 100, 50 (beam 0) and 1, 1 (beam 1); 0.9 is below 1e-2 of its beam's 100. Errors .1, 0, .3,
  // 0.
  const auto error =
      compare_images(image_of(2, {110, 50, 5, 1.3F, 1, 0}), image_of(2, {100, 50, 0.9F, 1, 1, 0}));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->bins, 4U);
  EXPECT_NEAR(error->bin_rms, std::sqrt((0.01 + 0.09) / 4), 1e-7);
}

TEST(ImageError, TrimmingDropsTheWorstHundredth) {
  std::vector<float> truth(200, 1.0F), measured(200, 1.01F);
  measured[17] = 9;
  measured[101] = 0;  // two of 200: the share that is dropped
  const auto error = compare_images(image_of(1, measured), image_of(1, truth));
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->bin_rms_trim, 0.01, 1e-6);
  EXPECT_NEAR(error->bin_rms, std::sqrt((198 * 1e-4 + 64 + 1) / 200), 1e-6);
}

TEST(ImageError, FirstEchoIsFoundInsideABin) {
  // 1e-2 of the largest (100) is 1: reached after 1/100 of bin 2 in the reference, after 1/50 of bin 1 and
  // after half of bin 4 in the two images.
  const render::EchoImage truth = image_of(1, {0, 0, 100, 50, 0});
  EXPECT_NEAR(compare_images(image_of(1, {0, 50, 100, 0, 0}), truth)->first_echo_bins, 2.01 - 1.02, 1e-9);
  EXPECT_NEAR(compare_images(image_of(1, {0, 0, 0, 0, 2}), truth)->first_echo_bins, 4.5 - 2.01, 1e-9);
  // Without an echo: the end of the beam.
  EXPECT_NEAR(compare_images(image_of(1, {0, 0, 0, 0, 0}), truth)->first_echo_bins, 5 - 2.01, 1e-9);
}

TEST(ImageError, TheWorstBeamGivesTheFirstEcho) {
  const auto error = compare_images(image_of(2, {0, 8, 0, 8, 0, 0}), image_of(2, {0, 8, 0, 0, 8, 0}));
  EXPECT_NEAR(error->first_echo_bins, 1, 1e-9);
}

TEST(ImageError, CountsHolesAmongLoudAndFaintBins) {
  // Loud: 1, 1; faint: also 1e-3, 1e-5; beyond: 1e-7. A bin of 1e-4 of its truth counts as empty, 1e-2 does
  // not.
  const render::EchoImage truth = image_of(1, {1, 1, 1e-3F, 1e-5F, 1e-7F});
  const auto error = compare_images(image_of(1, {1, 1e-4F, 1e-5F, 0, 0}), truth);
  EXPECT_EQ(error->hole_fraction, 1.0 / 2);
  EXPECT_EQ(error->hole_fraction_60db, 2.0 / 4);
}

TEST(ImageError, ComparesTotalsOfBeamsThatHear) {
  const auto error = compare_images(image_of(3, {1, 2, 0, 0, 4, 4}), image_of(3, {2, 2, 0, 0, 4, 4}));
  EXPECT_NEAR(error->beam_total_worst, 0.25, 1e-12);
  EXPECT_NEAR(error->beam_total_mean, 0.125, 1e-12);  // the silent beam does not count
}

TEST(ImageError, NothingToCompareInEmptyWater) {
  EXPECT_FALSE(compare_images(image_of(1, {1, 2}), image_of(1, {0, 0})));
}

TEST(ImageError, RefusesImagesOfDifferentSize) {
  EXPECT_THROW(compare_images(image_of(1, {1, 2}), image_of(2, {1, 2})), std::invalid_argument);
}

}  // namespace
}  // namespace sonard::bench
