// SPDX-License-Identifier: Apache-2.0
// A client's lines from a Micron, through the settings of a job, the receiver and the codec (docs/physics.md
// 2.16).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/correlation.hpp"
#include "tests/support/micron_client.hpp"

namespace sonard {
namespace {

using test::decibels_of;
using test::MicronClient;

constexpr int bins = 500;
constexpr double range_m = 25;  // in bins of 50 mm, by default

std::size_t bin_at(double wanted_m) {
  return static_cast<std::size_t>(wanted_m / range_m * bins);
}

TEST(MicronImage, CodesAreOnTheHalfDecibelGridAndNoneIsAbove191) {
  std::set<int> grid;
  for (int k = 0; k <= 120; ++k) {
    grid.insert(k * 255 / 160);
  }
  EXPECT_EQ(*grid.rbegin(), 191);
  MicronClient client{server::micron_type().make_default()};
  std::set<int> seen;
  for (float intensity = 1e-14F; intensity < 1e-2F; intensity *= 10) {
    for (const std::uint8_t code : client.line(intensity)) {
      ASSERT_TRUE(grid.contains(code)) << int{code};
      seen.insert(code);
    }
  }
  EXPECT_GT(seen.size(), 100u);
  EXPECT_EQ(*seen.rbegin(), 191);
}

// Blank first row; a peak at 0.2 to 0.35 m, gone by 0.8 to 1 m. It reaches 20 to 25 dB at a gain of 58 %, and
// 52 at 88 %, with a standard deviation of 1.5 to 3 dB from ping to ping. Behind it the vehicle reverberates
// for 2 to 4 m: at 88 % more than 20 dB at 1.5 m, and almost 0 at 4 m.
TEST(MicronImage, RingDownPeaksAndIsGoneWithinAMetre) {
  server::HeadConfig head = server::micron_type().make_default();
  head.acoustics.physical.noise.interference.probability = 0;
  MicronClient client{head};
  const double nominal_gain_db = client.gain_db;
  const auto measure = [&](double gain_percent) {
    client.gain_db = gain_percent * 0.8;
    constexpr int pings = 400;
    double sum_db = 0, squares = 0;
    for (int ping = 0; ping < pings; ++ping) {
      const std::vector<std::uint8_t> line = client.line(0);
      EXPECT_EQ(line[0], 0);
      const auto peak = std::max_element(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(bin_at(2)));
      const double peak_m = (static_cast<double>(peak - line.begin()) + 0.5) * range_m / bins;
      EXPECT_GE(peak_m, 0.2);
      EXPECT_LE(peak_m, 0.35);
      sum_db += decibels_of(*peak);
      squares += decibels_of(*peak) * decibels_of(*peak);
    }
    const double mean_db = sum_db / pings;
    const double sd_db = std::sqrt(squares / pings - mean_db * mean_db);
    std::printf("gain %.0f %%: ring-down of %.1f dB, sd %.2f\n", gain_percent, mean_db, sd_db);
    EXPECT_GE(sd_db, 1.5);
    EXPECT_LE(sd_db, 3);
    return mean_db;
  };
  const double at_58 = measure(58);
  EXPECT_GE(at_58, 20);
  EXPECT_LE(at_58, 25);
  // A level of -40 dB, the TVG of 30 log 0.275 m, and -9 dB re 80 dB at the nominal gain.
  EXPECT_NEAR(at_58, -40 + 30 * std::log10(0.275) - 9 + 80 + (58 * 0.8 - nominal_gain_db), 1);
  EXPECT_NEAR(measure(88), 52, 4);
  const auto mean_db = [&](double from_m, double to_m) {
    const std::vector<std::uint8_t> line = client.line(0);
    double sum_db = 0;
    for (std::size_t bin = bin_at(from_m); bin < bin_at(to_m); ++bin) {
      sum_db += decibels_of(line[bin]);
    }
    return sum_db / static_cast<double>(bin_at(to_m) - bin_at(from_m));
  };
  EXPECT_GT(mean_db(1.3, 1.7), 20);
}

TEST(MicronImage, AHeadThatOnlyListensDoesNotRing) {
  MicronClient client{server::micron_type().make_default()};
  EXPECT_LT(decibels_of(client.line(0, false)[bin_at(0.3)]), 12);  // noise: 5 dB and two standard deviations
}

// Empty water to 50 m in bins of 64 mm at a gain of 28 %: 29 % zeros, spread over all ranges. From 34 m on a
// floor of 4 to 6 dB, with a standard deviation of levels of 2.5 to 3.2 dB.
TEST(MicronImage, EmptyWaterAlwaysShowsSomething) {
  server::HeadConfig head = server::micron_type().make_default();
  head.acoustics.physical.noise.interference.probability = 0;
  head.acoustics.physical.noise.by_bearing_db = 0;
  MicronClient client{head, 0.064, 780};
  client.gain_db = 0.28 * 80;
  double zeros = 0, count = 0, floor_db = 0, squares = 0, far = 0;
  for (int ping = 0; ping < 200; ++ping) {
    const std::vector<std::uint8_t> line = client.line(0);
    for (std::size_t bin = 20; bin < line.size(); ++bin) {
      const double at_m = 0.064 * (static_cast<double>(bin) + 0.5);
      zeros += line[bin] == 0 ? 1 : 0;
      ++count;
      if (at_m > 34) {
        floor_db += decibels_of(line[bin]);
        squares += decibels_of(line[bin]) * decibels_of(line[bin]);
        ++far;
      }
    }
  }
  const double mean_db = floor_db / far;
  const double sd_db = std::sqrt(squares / far - mean_db * mean_db);
  std::printf("zeros %.3f, floor %.2f dB, sd %.2f\n", zeros / count, mean_db, sd_db);
  EXPECT_NEAR(zeros / count, 0.29, 0.08);
  EXPECT_NEAR(mean_db, 5, 1);
  EXPECT_GE(sd_db, 2.5);
  EXPECT_LE(sd_db, 3.2);
}

// docs/physics.md 2.16: recorded levels to 50 m in 794 bins have a standard deviation of 2.9 dB and share
// 0.38 to 0.49 with the next bin. A level is a weighted mean of the decibels of independent half bins, each
// with a standard deviation of 5.57 dB (Rayleigh): o 1 1 o. So neighbours share 2 o / (2 + 2 o^2), and bins
// farther apart share 0. For noise, and for an even echo 25 dB over the noise.
TEST(MicronImage, NeighbouringBinsOverlap) {
  for (const double overlap : {0.25, 0.55, 1.0}) {
    for (const bool echo : {false, true}) {
      server::HeadConfig head = server::micron_type().make_default();
      if (overlap != 0.55) {  // the default
        head.acoustics.physical.bin_overlap = overlap;
      }
      head.acoustics.physical.tvg.log_coefficient = 0;
      head.acoustics.physical.tvg.absorption_db_per_m = 0;
      head.acoustics.physical.noise.interference.probability = 0;
      head.acoustics.physical.noise.by_bearing_db = 0;
      head.acoustics.physical.noise.level_db = (echo ? 15 : 40) - 80 + 9;
      MicronClient client{head, 0.063, 794};
      std::vector<double> here, next, after_next;
      for (int step = 0; step < 40; ++step) {  // three beams from each other
        const std::vector<std::uint8_t> line =
            client.line(echo ? static_cast<float>(std::pow(10, (40 - 80 + 9) / 10.0)) : 0.0F, true,
                        step * 2 * std::numbers::pi / 40);
        for (std::size_t bin = 100; bin + 3 < line.size(); ++bin) {
          here.push_back(decibels_of(line[bin]));
          next.push_back(decibels_of(line[bin + 1]));
          after_next.push_back(decibels_of(line[bin + 2]));
        }
      }
      const double mean = std::accumulate(here.begin(), here.end(), 0.0) / static_cast<double>(here.size());
      double square = 0;
      for (const double level : here) {
        square += (level - mean) * (level - mean) / static_cast<double>(here.size());
      }
      const double weights = 2 + 2 * overlap * overlap;
      EXPECT_NEAR(test::correlation(here, next), 2 * overlap / weights, 0.03) << overlap << echo;
      EXPECT_NEAR(test::correlation(here, after_next), 0, 0.03) << overlap << echo;
      EXPECT_NEAR(std::sqrt(square), 5.57 * std::sqrt(weights) / (2 + 2 * overlap), 0.1) << overlap << echo;
    }
  }
}

// docs/physics.md 2.16: from sweep to sweep of a vehicle at rest, echoes repeat by about 0.95; noise does
// not. An even echo 20 dB above the noise, and noise alone, at 40 dB in every bin; levels in dB.
TEST(MicronImage, EchoesRepeatFromSweepToSweepAndNoiseDoesNot) {
  server::HeadConfig head = server::micron_type().make_default();
  head.acoustics.physical.tvg.log_coefficient = 0;
  head.acoustics.physical.tvg.absorption_db_per_m = 0;
  head.acoustics.physical.noise.level_db = 40 - 80 + 9 - 20;
  head.acoustics.physical.noise.interference.probability = 0;
  head.acoustics.physical.noise.by_bearing_db = 0;
  const auto sweep = [](MicronClient& client, float intensity) {
    std::vector<double> levels;
    for (double bearing = -3; bearing < 3; bearing += 0.05) {
      const std::vector<std::uint8_t> line = client.line(intensity, true, bearing);
      for (std::size_t bin = bin_at(2); bin < line.size(); ++bin) {
        levels.push_back(std::pow(10, decibels_of(line[bin]) / 20));
      }
    }
    return levels;
  };
  const auto echo = static_cast<float>(std::pow(10, (40 - 80 + 9) / 10.0));
  MicronClient client{head};
  const double of_echo = test::correlation(sweep(client, echo), sweep(client, echo));
  head.acoustics.physical.noise.level_db += 20;
  MicronClient hearing_noise{head};
  const double of_noise = test::correlation(sweep(hearing_noise, 0), sweep(hearing_noise, 0));
  std::printf("echo %.3f, noise %.3f\n", of_echo, of_noise);
  EXPECT_NEAR(of_echo, 0.95, 0.02);
  EXPECT_LT(std::abs(of_noise), 0.05);
}

// docs/physics.md 2.16: recorded lines 1.8 degrees apart share .47 of an echo, including the structure that
// all beds have. For an even echo, a field of exp(-(d / 3 degrees)^2) leaves .40 after the mean of four
// decibels. Noise shares 0; its mean level differs between bearings by up to 7 dB and is constant.
TEST(MicronImage, LinesShareTheirEchoWithTheNextAndNoiseWithTheNextSweep) {
  server::HeadConfig head = server::micron_type().make_default();
  head.acoustics.physical.tvg.log_coefficient = 0;
  head.acoustics.physical.tvg.absorption_db_per_m = 0;
  head.acoustics.physical.noise.interference.probability = 0;
  const auto sweep = [](MicronClient& client, float intensity) {
    std::vector<std::vector<double>> levels;
    for (int step = 0; step < 200; ++step) {
      const std::vector<std::uint8_t> line = client.line(intensity, true, step * 2 * std::numbers::pi / 200);
      levels.emplace_back();
      for (std::size_t bin = bin_at(5); bin < line.size(); ++bin) {
        levels.back().push_back(decibels_of(line[bin]));
      }
    }
    return levels;
  };
  const auto amplitude_of = [](double level_db) { return std::pow(10, level_db / 20); };
  const auto shared = [&](const std::vector<std::vector<double>>& levels, std::size_t lines) {
    std::vector<double> here, there;
    for (std::size_t i = 0; i + lines < levels.size(); ++i) {
      std::ranges::transform(levels[i], std::back_inserter(here), amplitude_of);
      std::ranges::transform(levels[i + lines], std::back_inserter(there), amplitude_of);
    }
    return test::correlation(here, there);
  };
  const auto means = [](const std::vector<std::vector<double>>& levels) {
    std::vector<double> mean;
    for (const std::vector<double>& line : levels) {
      mean.push_back(std::accumulate(line.begin(), line.end(), 0.0) / static_cast<double>(line.size()));
    }
    return mean;
  };
  MicronClient echoes{head};
  const auto echo = sweep(echoes, static_cast<float>(std::pow(10, (40 - 80 + 9) / 10.0)));
  std::printf("lines share %.3f %.3f %.3f\n", shared(echo, 1), shared(echo, 2), shared(echo, 3));
  EXPECT_NEAR(shared(echo, 1), 0.40, 0.04);
  head.acoustics.physical.noise.level_db = 40 - 80 + 9;
  MicronClient noises{head};
  const std::vector<double> first = means(sweep(noises, 0));
  const std::vector<double> second = means(sweep(noises, 0));
  const auto [least, most] = std::ranges::minmax(first);
  std::printf("noise of bearings: %.1f dB, sweeps share %.3f\n", most - least,
              test::correlation(first, second));
  EXPECT_NEAR(most - least, 6.5, 1);
  EXPECT_GT(test::correlation(first, second), 0.95);
  head.acoustics.physical.noise.by_bearing_db = 0;
  MicronClient even{head};
  EXPECT_LT(std::abs(shared(sweep(even, 0), 1)), 0.02);
}

// Noise of 40 dB in every bin, and bursts of 10 dB, so that each is visible: 14 to 18 % of the lines have
// one, of a median length of 3 to 5 m. One burst in ten lasts to the end of the 25 m anyway, and of the
// others 4 m * 3 / (4 ln 2) / 25 m = 17.3 %: 25.6 % in all (at 60 m one in six).
TEST(MicronImage, OnePingOfSixIsHitByABurstOfInterference) {
  server::HeadConfig head = server::micron_type().make_default();
  head.acoustics.physical.tvg.log_coefficient = 0;
  head.acoustics.physical.tvg.absorption_db_per_m = 0;
  head.acoustics.physical.noise.level_db = 40 - 80 + 9;
  EXPECT_EQ(head.acoustics.physical.noise.interference.least_db, 2);
  EXPECT_EQ(head.acoustics.physical.noise.interference.most_db, 11);
  head.acoustics.physical.noise.interference.least_db = 10;
  head.acoustics.physical.noise.interference.most_db = 10;
  MicronClient client{head};
  constexpr int window = 20;  // 1 m: a mean intensity known to 1 dB
  constexpr int pings = 3000;
  int hit = 0, to_the_end = 0;
  std::vector<int> lengths_m;
  for (int ping = 0; ping < pings; ++ping) {
    const std::vector<std::uint8_t> line = client.line(0);
    int raised = 0;
    bool last = false;
    for (int begin = window; begin < bins; begin += window) {  // the first metre is the ring-down's
      double power = 0;
      for (int bin = begin; bin < begin + window; ++bin) {
        power += std::pow(10.0, decibels_of(line[static_cast<std::size_t>(bin)]) / 10) / window;
      }
      last = 10 * std::log10(power) > 45.5;
      raised += last ? 1 : 0;
    }
    if (raised > 0) {
      ++hit;
      to_the_end += last ? 1 : 0;
      lengths_m.push_back(raised);
    }
  }
  ASSERT_GT(hit, 0);
  std::ranges::nth_element(lengths_m, lengths_m.begin() + hit / 2);
  const int median_m = lengths_m[static_cast<std::size_t>(hit / 2)];
  std::printf("%.3f of the lines, %d m, %.3f of them to the end\n", static_cast<double>(hit) / pings,
              median_m, static_cast<double>(to_the_end) / hit);
  EXPECT_GE(hit, 0.14 * pings);
  EXPECT_LE(hit, 0.18 * pings);
  EXPECT_GE(median_m, 3);
  EXPECT_LE(median_m, 5);
  EXPECT_NEAR(static_cast<double>(to_the_end) / hit, 0.256, 4 * 0.436 / std::sqrt(hit));
}

}  // namespace
}  // namespace sonard
