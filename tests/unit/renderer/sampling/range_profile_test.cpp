// SPDX-License-Identifier: Apache-2.0
// One beam's echo over range, against sums over many azimuths.
#include "renderer/binning/range_profile.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numeric>
#include <ostream>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace sonard::render {
namespace {

// Lines over which sharper ends and narrower patches are drawn.
constexpr double least = 1e-3;

/// As EchoPatch, in lines.
struct Patch {
  double a = 0.0;
  float smear_a = 0.0F;
  double b = 0.0;
  float smear_b = 0.0F;
  float gradient = 0.0F;
  float amount = 1.0F;

  double spread() const { return b - a; }
  double mean() const { return static_cast<double>(amount) / std::abs(spread()); }
};

std::ostream& operator<<(std::ostream& out, const Patch& patch) {
  return out << "a " << patch.a << " +- " << patch.smear_a / 2 << ", b " << patch.b << " +- "
             << patch.smear_b / 2 << ", gradient " << patch.gradient;
}

void add(RangeProfile& profile, const Patch& patch) {
  profile.add(patch.a, patch.smear_a, patch.b, patch.smear_b, patch.amount, patch.gradient);
}

std::vector<float> lines_of(const std::vector<Patch>& patches, std::size_t lines) {
  double total = 0.0;
  for (const Patch& patch : patches) {
    total += static_cast<double>(patch.amount);
  }
  RangeProfile profile;
  profile.reset(lines, total);
  for (const Patch& patch : patches) {
    add(profile, patch);
  }
  profile.finish();
  std::vector<float> result(lines);
  profile.read(result.data());
  return result;
}

double sum_of(const std::vector<float>& lines) {
  return std::accumulate(lines.begin(), lines.end(), 0.0);
}

/// Adds the echo of one azimuth, from one end to the other. The echo per line has the same mean at all
/// azimuths: if the ends are closer, the echo is weaker.
void add_azimuth(const Patch& patch, double azimuth, double width, std::vector<double>& sums) {
  const double a = patch.a + azimuth * static_cast<double>(patch.smear_a);
  const double b = patch.b + azimuth * static_cast<double>(patch.smear_b);
  const double amount = static_cast<double>(patch.amount) * width * (b - a) / patch.spread();
  const auto gradient = static_cast<double>(patch.gradient);
  const auto share_to = [&](double line) {
    const double way = std::clamp((line - a) / (b - a), 0.0, 1.0);  // from end a
    return way * (1 - gradient) + way * way * gradient;
  };
  for (std::size_t k = 0; k < sums.size(); ++k) {
    const auto line = static_cast<double>(k);
    sums[k] += amount * std::abs(share_to(line + 1) - share_to(line));
  }
}

std::vector<double> brute_force(const Patch& patch, std::size_t lines) {
  constexpr int azimuths = 4000;
  std::vector<double> sums(lines);
  for (int i = 0; i < azimuths; ++i) {
    add_azimuth(patch, (i + 0.5) / azimuths - 0.5, 1.0 / azimuths, sums);
  }
  return sums;
}

/// Largest error of a line. A sharp end that is drawn over `least` carries an eighth of that beyond itself.
/// The rest is the rounding to float and the steps of brute force.
double bound_of(const Patch& patch) {
  const int sharp_ends = (patch.smear_a > 0 ? 0 : 1) + (patch.smear_b > 0 ? 0 : 1);
  return patch.mean() * (sharp_ends * least / 8 + 2e-6);
}

/// The rise from end to end is not smeared. At an end, smearing a kink by w lines moves the density by
/// slope * w / 8 and the sum by slope * w^2 / 24. Between ends of different smears it moves the density
/// by no more than mean * gradient * (w / spread)^2 / 3.
double gradient_bound_of(const Patch& patch) {
  const auto w = static_cast<double>(std::max(patch.smear_a, patch.smear_b));
  const double change = patch.mean() * std::abs(static_cast<double>(patch.gradient));
  const double way = w / std::abs(patch.spread());
  const double slope = 2 * change / std::abs(patch.spread());
  const double between = patch.smear_a == patch.smear_b ? 0.0 : change * way * way / 3;
  return bound_of(patch) + 2 * slope * std::min(w / 8, w * w / 24) + between;
}

void expect_lines(const Patch& patch, std::size_t lines, double bound) {
  const std::vector<float> got = lines_of({patch}, lines);
  const std::vector<double> truth = brute_force(patch, lines);
  for (std::size_t k = 0; k < lines; ++k) {
    EXPECT_NEAR(static_cast<double>(got[k]), truth[k], bound) << patch << ", line " << k;
  }
}

TEST(RangeProfile, EchoRunsBetweenTheTwoEnds) {
  for (const Patch& patch : {Patch{20.3, 1.5F, 27.9, 1.5F},
                             {20.3, 0.7F, 27.9, 3.1F},
                             {20.3, 4.0F, 27.9, 0.2F},
                             {20, 0.0F, 23, 0.0F},       // whole lines, sharp
                             {20.25, 0.0F, 20.5, 0.0F},  // within a line
                             {20.7, 0.0F, 26.1, 5.0F},
                             {21, 0.05F, 21.4, 0.6F},
                             {30, 12.0F, 36, 12.0F},  // longer than the lines that are added at a time
                             {30.6, 8.0F, 47.1, 25.5F},
                             {50.1, 80.0F, 60.3, 80.0F},
                             {50, 16.0F, 50.01, 16.0F}}) {
    expect_lines(patch, 100, bound_of(patch));
  }
}

TEST(RangeProfile, EndsComeInAnyOrder) {
  for (const Patch& patch : {Patch{27.9, 1.5F, 20.3, 1.5F},
                             {27.9, 0.0F, 20.3, 3.0F},
                             {47.1, 25.5F, 30.6, 8.0F},
                             {20.5, 0.0F, 20.25, 0.0F}}) {
    expect_lines(patch, 100, bound_of(patch));
    const std::vector<float> reversed = lines_of({{patch.b, patch.smear_b, patch.a, patch.smear_a}}, 100);
    const std::vector<float> lines = lines_of({patch}, 100);
    for (std::size_t k = 0; k < lines.size(); ++k) {
      EXPECT_NEAR(lines[k], reversed[k], 1e-7F) << patch << ", line " << k;
    }
  }
}

TEST(RangeProfile, EchoWithAGradientRisesFromEndToEnd) {
  for (const float gradient : {0.3F, -0.7F, 1.0F}) {
    for (const Patch& patch : {Patch{20.3, 0.0F, 27.9, 0.0F, gradient},
                               {20, 0.0F, 23, 0.0F, gradient},
                               {20.25, 0.0F, 20.5, 0.0F, gradient},
                               {20.7, 0.0F, 21.2, 0.0F, gradient},
                               {20.3, 0.5F, 27.9, 0.5F, gradient},
                               {20.3, 3.5F, 27.9, 0.5F, gradient},
                               {20.3, 0.2F, 27.9, 3.8F, gradient},
                               {20.3, 0.5F, 21.3, 0.1F, gradient},
                               {30.6, 20.0F, 71.1, 11.0F, gradient},
                               {27.9, 0.0F, 20.3, 0.0F, gradient},
                               {27.9, 1.0F, 20.3, 2.5F, gradient}}) {
      expect_lines(patch, 100, gradient_bound_of(patch));
    }
  }
}

/// Surfaces make patches with a gradient only if the ends run no farther than half of their length.
bool is_possible(const Patch& patch) {
  const auto a = static_cast<double>(patch.smear_a), b = static_cast<double>(patch.smear_b);
  return patch.gradient == 0.0F || (a + b) / 2 <= patch.spread() / 2;
}

/// For a patch whose ends cross: its echo on one side, in units of its amount, which a negative echo on the
/// other side balances; else 0.
double crossing_of(const Patch& patch) {
  const double difference = std::abs(static_cast<double>(patch.smear_a - patch.smear_b));
  const double spread = std::max(patch.spread(), least);
  return difference > 2 * spread ? difference / (8 * spread) : 0.0;
}

// Even if the ends cross. Lines are floats.
TEST(RangeProfile, KeepsAllOfTheEcho) {
  for (const double begin : {150.0, 150.005, 150.37, 150.995}) {
    for (const double spread : {0.0, 1e-6, 1.3e-3, 0.5, 3.0, 100.0}) {
      for (const float smear_a : {0.0F, 1e-3F, 0.02F, 2.0F, 20.0F}) {
        for (const float smear_b : {0.0F, 1e-3F, 0.01F, 2.0F, 20.0F}) {
          for (const float gradient : {0.0F, 0.3F, -0.7F}) {
            const Patch patch{begin, smear_a, begin + spread, smear_b, gradient, 0.37F};
            if (is_possible(patch)) {
              EXPECT_NEAR(sum_of(lines_of({patch}, 300)) / static_cast<double>(patch.amount), 1.0,
                          1e-6 + 6e-8 * crossing_of(patch))
                  << patch;
            }
          }
        }
      }
    }
  }
}

// Patches of one surface: each begins where the last one ends.
TEST(RangeProfile, PatchesThatContinueEachOtherAddUp) {
  const std::vector<Patch> chain{{10.2, 1.5F, 14.7, 0.5F, 0.2F, 1.0F},
                                 {14.7, 0.5F, 17.1, 0.5F, -0.4F, 0.2F},
                                 {17.1, 0.5F, 12.4, 0.0F, 0.0F, 2.0F},
                                 {12.4, 0.0F, 30.3, 9.0F, 0.0F, 0.7F},
                                 {30.3004, 9.0F, 41.0, 9.0F, 0.0F, 1.1F}};
  const std::vector<float> got = lines_of(chain, 60);
  std::vector<double> truth(60);
  double bound = 0.0;
  for (const Patch& patch : chain) {
    const std::vector<double> one = brute_force(patch, truth.size());
    std::transform(one.begin(), one.end(), truth.begin(), truth.begin(), std::plus<>());
    bound += gradient_bound_of(patch);
  }
  // The last one is moved to the end it continues.
  bound += 0.0004 * chain.back().mean();
  for (std::size_t k = 0; k < truth.size(); ++k) {
    EXPECT_NEAR(static_cast<double>(got[k]), truth[k], bound) << "line " << k;
  }
}

/// Patches between lines 0 and 300. Some are very narrow and have no gradient, because a visible segment has
/// no gradient if it would move the echo by less than a fiftieth of a line.
std::vector<Patch> random_patches(std::size_t count, bool with_gradient) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> position(20, 280);
  std::uniform_real_distribution<float> smear(0.0F, 30.0F), amount(0.0F, 1.0F), gradient(-0.8F, 0.8F);
  std::uniform_real_distribution<double> shift(-5, 5);
  std::bernoulli_distribution is_narrow(0.2);
  std::vector<Patch> patches(count);
  for (Patch& patch : patches) {
    patch.a = position(random);
    patch.b = is_narrow(random) ? patch.a + 0.001 * shift(random) : position(random);
    patch.smear_a = smear(random);
    patch.smear_b = smear(random);
    patch.amount = amount(random);
    patch.gradient = with_gradient && std::abs(patch.spread()) > 0.03 ? gradient(random) : 0.0F;
  }
  return patches;
}

TEST(RangeProfile, OrderOfPatchesChangesNoBit) {
  std::mt19937 random(8);
  for (const bool with_gradient : {false, true}) {
    std::vector<Patch> patches = random_patches(5000, with_gradient);
    const std::vector<float> lines = lines_of(patches, 250);
    for (int time = 0; time < 5; ++time) {
      std::shuffle(patches.begin(), patches.end(), random);
      EXPECT_EQ(lines_of(patches, 250), lines);
    }
  }
}

/// Expects that patches leave nothing beyond their ends, not even a negative rest, which read() would hide: a
/// point far beyond them has so little echo that one unit more or less would show.
void expect_nothing_beyond(const std::vector<Patch>& patches) {
  const auto total = static_cast<double>(std::bit_ceil(patches.size()));
  const auto little = static_cast<float>(total * 0x1p-20);
  RangeProfile profile;
  profile.reset(400, total);
  for (const Patch& patch : patches) {
    add(profile, patch);
  }
  profile.add_point(350.5, little);
  profile.finish();
  std::vector<float> lines(400);
  profile.read(lines.data());
  EXPECT_GT(sum_of(lines), 0.0);
  std::vector<float> beyond(100);
  beyond[50] = little;
  EXPECT_EQ(std::vector<float>(lines.begin() + 300, lines.end()), beyond);
}

TEST(RangeProfile, NothingIsLeftWhereEverythingHasEnded) {
  for (const bool with_gradient : {false, true}) {
    for (const std::size_t count : {std::size_t{1}, std::size_t{50}, std::size_t{100000}}) {
      expect_nothing_beyond(random_patches(count, with_gradient));
    }
    for (const Patch& patch : random_patches(500, with_gradient)) {
      expect_nothing_beyond({patch});
    }
  }
}

TEST(RangeProfile, WhatLiesOutsideIsDropped) {
  constexpr std::size_t lines = 40;
  for (const Patch& patch : {Patch{-5.3, 0.0F, 7.6, 0.0F},
                             {-5.3, 3.0F, 7.6, 4.0F},
                             {-1.2, 9.0F, 3.3, 9.0F},
                             {7.6, 3.0F, -2.1, 11.0F},
                             {0.4, 6.0F, 5.1, 2.0F},
                             {-30, 2.0F, 60, 5.0F},
                             {36.2, 2.0F, 47.7, 5.0F},
                             {38.5, 20.0F, 47.7, 20.0F},
                             {47.7, 5.0F, 36.2, 2.0F},
                             {-9, 1.0F, -3, 1.0F},
                             {43, 1.0F, 49, 1.0F}}) {
    expect_lines(patch, lines, bound_of(patch));
  }
}

// No end lies before line 0, at a negative range, but its smear may.
TEST(RangeProfile, WhatLiesOutsideIsDroppedOfPatchesWithAGradientToo) {
  constexpr std::size_t lines = 40;
  for (const float gradient : {0.3F, -0.7F}) {
    for (const Patch& patch : {Patch{36.2, 0.0F, 47.7, 0.0F, gradient},
                               {36.2, 2.0F, 47.7, 5.0F, gradient},
                               {47.7, 0.0F, 36.2, 0.0F, gradient},
                               {39.6, 0.0F, 40.9, 0.0F, gradient},
                               {38.3, 0.0F, 39.9, 0.0F, gradient},
                               {43, 1.0F, 49, 1.0F, gradient},
                               {0.0, 0.0F, 7.6, 0.0F, gradient},
                               {0.7, 4.0F, 10.2, 2.0F, gradient},
                               {10.2, 2.0F, 0.7, 4.0F, gradient},
                               {0.7, 2.0F, 57.1, 5.0F, gradient}}) {
      expect_lines(patch, lines, gradient_bound_of(patch));
    }
  }
}

TEST(RangeProfile, IsNeverNegativeAndAlwaysFinite) {
  for (const double a : {-1e9, -3.0, 0.0, 50.2, 99.9, 1e9}) {
    for (const double spread : {0.0, 1e-9, 2.5, -70.0, 1e9}) {
      for (const float smear_a : {0.0F, 3.0F, 511.0F, 1e9F}) {
        for (const float smear_b : {0.0F, 1e9F}) {
          for (const float gradient : {0.0F, 0.5F}) {
            const Patch patch{a, smear_a, a + spread, smear_b, gradient};
            const std::vector<float> lines = lines_of({patch}, 100);
            EXPECT_TRUE(std::all_of(lines.begin(), lines.end(), [](float line) {
              return std::isfinite(line) && line >= 0.0F;
            })) << patch;
          }
        }
      }
    }
  }
}

TEST(RangeProfile, PointsFallIntoOneLine) {
  RangeProfile profile;
  profile.reset(50, 4.0);
  profile.add_point(0.0, 0.5F);
  profile.add_point(12.999, 1.0F);
  profile.add_point(49.999, 0.25F);
  for (const double outside : {-0.001, 50.0, 1e30, -1e30}) {
    profile.add_point(outside, 1.0F);
  }
  profile.finish();
  std::vector<float> truth(50), lines(50);
  truth[0] = 0.5F;
  truth[12] = 1.0F;
  truth[49] = 0.25F;
  profile.read(lines.data());
  EXPECT_EQ(lines, truth);
}

TEST(RangeProfile, ResetForgetsEverything) {
  RangeProfile profile;
  for (const std::size_t lines : {std::size_t{100}, std::size_t{100}, std::size_t{60}, std::size_t{200}}) {
    profile.reset(lines, 1.0);
    std::vector<float> read(lines, 1.0F);
    profile.finish();
    profile.read(read.data());
    EXPECT_EQ(read, std::vector<float>(lines));
    add(profile, {20.3, 1.5F, 57.9, 2.5F, 0.4F});
    add(profile, {37.9, 1.5F, 20.3, 2.5F});  // not finished
  }
}

}  // namespace
}  // namespace sonard::render
