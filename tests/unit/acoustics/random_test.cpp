#include "renderer/acoustics/random.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/acoustics/beam_kernel.hpp"

namespace sonard::render {
namespace {

struct Moments {
  double mean_re = 0, mean_im = 0, power = 0, fourth = 0, cross = 0, neighbour = 0;
  int count = 0;
};

Moments moments_of(RandomKey key, int rows, int columns) {
  Moments m;
  std::vector<float> re(static_cast<std::size_t>(columns));
  std::vector<float> im(re.size());
  for (int row = 0; row < rows; ++row) {
    fill_complex_gaussian(key, static_cast<std::uint32_t>(row), columns, re.data(), im.data());
    for (std::size_t i = 0; i < re.size(); ++i) {
      const double x = static_cast<double>(re[i]);
      const double y = static_cast<double>(im[i]);
      m.mean_re += x;
      m.mean_im += y;
      m.power += x * x + y * y;
      m.fourth += (x * x + y * y) * (x * x + y * y);
      m.cross += x * y;
      if (i > 0) {
        m.neighbour += x * static_cast<double>(re[i - 1]);
      }
      ++m.count;
    }
  }
  return m;
}

// CN(0, 1): E|z|^2 = 1, E|z|^4 = 2, independent parts and neighbours. Bounds are five standard errors of n =
// 1e6.
TEST(Random, IsCircularComplexGaussian) {
  for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{1}, ~std::uint64_t{0}}) {
    const Moments m = moments_of(make_random_key(seed, 0, RandomField::noise, 7), 1000, 1000);
    const double n = m.count;
    const double standard_error = 5 / std::sqrt(n);
    EXPECT_NEAR(m.mean_re / n, 0, standard_error * std::sqrt(0.5));
    EXPECT_NEAR(m.mean_im / n, 0, standard_error * std::sqrt(0.5));
    EXPECT_NEAR(m.power / n, 1, standard_error);
    EXPECT_NEAR(m.fourth / n, 2, standard_error * std::sqrt(20.0));
    EXPECT_NEAR(m.cross / n, 0, standard_error * 0.5);
    EXPECT_NEAR(m.neighbour / n, 0, standard_error * 0.5);
  }
}

TEST(Random, FieldsAreUnrelated) {
  std::vector<float> re(4096), im(4096), other_re(4096), other_im(4096);
  const auto correlation = [&](RandomKey a, RandomKey b) {
    fill_complex_gaussian(a, 3, 4096, re.data(), im.data());
    fill_complex_gaussian(b, 3, 4096, other_re.data(), other_im.data());
    double sum = 0;
    for (std::size_t i = 0; i < re.size(); ++i) {
      sum += static_cast<double>(re[i] * other_re[i] + im[i] * other_im[i]);
    }
    return sum / 4096;
  };
  const RandomKey base = make_random_key(1, 0, RandomField::noise, 10);
  EXPECT_GT(correlation(base, base), 0.9);
  for (const RandomKey other :
       {make_random_key(2, 0, RandomField::noise, 10), make_random_key(1, 1, RandomField::noise, 10),
        make_random_key(1, 0, RandomField::speckle, 10),
        make_random_key(1, 0, RandomField::noise, 11)}) {
    EXPECT_NEAR(correlation(base, other), 0, 5.0 / 64);
  }
}

TEST(Random, RowsDoNotDependOnTheirLength) {
  std::vector<float> re(300), im(300), short_re(5), short_im(5);
  const RandomKey key = make_random_key(9, 2, RandomField::speckle, 0);
  fill_complex_gaussian(key, 17, 300, re.data(), im.data());
  fill_complex_gaussian(key, 17, 5, short_re.data(), short_im.data());
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(re[i], short_re[i]);
    EXPECT_EQ(im[i], short_im[i]);
  }
}

// docs/physics.md 2.8: field correlation about .88 / .60 / .3 at lag 1 / 2 / 3 for 256 sine-spaced beams.
TEST(BeamKernel, GivesTheGrainOfRealHeads) {
  Aperture aperture;
  aperture.beam_edges_rad = equal_sine_edges(256, 1.0471975511965976);
  const std::vector<float> kernel = receive_kernel(aperture);
  const auto field_correlation = [&](std::size_t lag) {
    double sum = 0;
    for (std::size_t i = 0; i + lag < kernel.size(); ++i) {
      sum += static_cast<double>(kernel[i] * kernel[i + lag]);
    }
    return sum;
  };
  EXPECT_NEAR(field_correlation(0), 1.0, 1e-6);
  EXPECT_NEAR(field_correlation(1), 0.88, 0.03);
  EXPECT_NEAR(field_correlation(2), 0.60, 0.03);
  EXPECT_NEAR(field_correlation(3), 0.30, 0.04);
}

TEST(BeamKernel, LoneOrDistantBeamsShareNothing) {
  Aperture aperture;
  aperture.beam_edges_rad = {0.1, -0.1};
  EXPECT_EQ(receive_kernel(aperture), std::vector<float>{1.0F});
  aperture.beam_edges_rad = equal_sine_edges(8, 1.0471975511965976);
  EXPECT_EQ(receive_kernel(aperture), std::vector<float>{1.0F});
}

}  // namespace
}  // namespace sonard::render
