// SPDX-License-Identifier: Apache-2.0
// The strongest echo in samples with a known truth (protocol/ping1d/README.md 3.4).
#include "protocol/ping1d/echo.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/protocol/ping1d/device/bed.hpp"

namespace sonard::ping1d {
namespace {

Echo echo_of(const PingImage& image, const Scan& scan, double least_range_mm = 300.0) {
  return find_echo(amplitudes(image), scan, 200, least_range_mm);
}
Echo echo_over(const Bed& bed, const Scan& scan) {
  return echo_of(image_of(make_job(scan, {}), bed), scan);
}

TEST(Ping1dEcho, AFlatBedIsWithin1MmOfItsClosedForm) {
  for (const std::uint32_t length_mm : {1000U, 2000U, 5000U, 10'000U, 20'000U, 30'000U, 50'000U, 100'000U}) {
    const Scan scan{.length_mm = length_mm};
    for (double share = 0.41; share < 0.9; share += 0.0137) {
      const double range_m = 1e-3 * length_mm * share;
      const Echo echo = echo_over({range_m}, scan);
      ASSERT_TRUE(echo.distance_mm) << range_m;
      EXPECT_NEAR(*echo.distance_mm, 1e3 * range_m, 1.0) << "length " << length_mm;
      EXPECT_GT(echo.confidence_percent, 75.0);
    }
  }
}

TEST(Ping1dEcho, AScanMayStartAnywhere) {
  const Scan scan{.start_mm = 38'000, .length_mm = 3000};
  const Echo echo = echo_over({40.0}, scan);
  EXPECT_NEAR(echo.distance_mm.value_or(0), 40'000.0, 1.0);
  EXPECT_NEAR(
      static_cast<double>(std::max_element(echo.profile.begin(), echo.profile.end()) - echo.profile.begin()),
      133.0, 1.0);
  EXPECT_FALSE(echo_over({30.0}, scan).distance_mm) << "before the scan";
}

TEST(Ping1dEcho, TheStrongerOfTwoBedsIsTheDistance) {
  const Scan scan;
  const PingJob job = make_job(scan, {});
  for (const auto& [near, far, expected] :
       {std::tuple{0.5, 0.3, 2000.0}, std::tuple{0.2, 0.5, 3000.0}, std::tuple{0.42, 0.4, 2000.0}}) {
    PingImage image = image_of(job, {2.0, near});
    add({3.0, far}, job, image);
    const Echo echo = echo_of(image, scan);
    EXPECT_NEAR(echo.distance_mm.value_or(0), expected, 1.0);
    EXPECT_LT(echo.confidence_percent, 61.0) << "there is another one";
  }
}

PingImage noise(const PingJob& job, double amplitude, unsigned seed) {
  std::mt19937 random(seed);
  std::exponential_distribution<double> energy;
  PingImage image;
  for (int k = 0; k < job.bins(); ++k) {
    image.u16.push_back(code_of(amplitude * std::sqrt(energy(random))));
  }
  return image;
}

TEST(Ping1dEcho, NoiseIsNoEcho) {
  const Scan scan;
  for (unsigned seed = 0; seed < 300; ++seed) {
    EXPECT_FALSE(echo_of(noise(make_job(scan, {}), 0.05, seed), scan).distance_mm) << seed;
  }
}

TEST(Ping1dEcho, ABedInNoiseAndSpeckleIsWithinASampleOrTwo) {
  const Scan scan;
  const PingJob job = make_job(scan, {});
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    std::exponential_distribution<double> energy;
    std::vector<float> samples = amplitudes(image_of(job, {2.0, 0.3}));
    const std::vector<float> floor = amplitudes(noise(job, 0.01, seed + 1000));
    for (std::size_t k = 0; k < samples.size(); ++k) {
      samples[k] = std::hypot(samples[k] * static_cast<float>(std::sqrt(energy(random))), floor[k]);
    }
    EXPECT_NEAR(find_echo(samples, scan, 200, 300.0).distance_mm.value_or(0), 2000.0, 10.0) << seed;
  }
}

TEST(Ping1dEcho, RingingIsInTheProfileButNotTheDistance) {
  const Scan scan{.length_mm = 2000};
  PingImage image = image_of(make_job(scan, {}), {1.2, 0.2});
  std::fill_n(image.u16.begin(), 250, 65535);
  const Echo echo = echo_of(image, scan);
  EXPECT_NEAR(echo.distance_mm.value_or(0), 1200.0, 1.0);
  EXPECT_EQ(echo.profile[10], 255);
  EXPECT_LT(echo.peak, 255);
  EXPECT_EQ(echo.saturated, 0);
}

TEST(Ping1dEcho, ABedThatSaturatesTheProfileIsWithin1MmToo) {
  for (const std::uint32_t length_mm : {5000U, 20'000U, 50'000U, 100'000U}) {
    const Scan scan{.length_mm = length_mm};
    for (const double amplitude : {2.0, 8.0, 50.0, 1000.0}) {
      for (double share = 0.41; share < 0.9; share += 0.0491) {
        const double range_m = 1e-3 * length_mm * share;
        const Echo echo = echo_over({range_m, amplitude}, scan);
        ASSERT_TRUE(echo.distance_mm) << range_m;
        EXPECT_NEAR(*echo.distance_mm, 1e3 * range_m, 1.0)
            << "length " << length_mm << ", amplitude " << amplitude;
        EXPECT_GT(echo.saturated, 0);
        EXPECT_EQ(echo.peak, 255);
      }
    }
  }
}

}  // namespace
}  // namespace sonard::ping1d
