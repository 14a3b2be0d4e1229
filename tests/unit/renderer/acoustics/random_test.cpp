// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/random.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/acoustics/beam_correlation.hpp"

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
        make_random_key(1, 0, RandomField::speckle, 10), make_random_key(1, 0, RandomField::noise, 11)}) {
    EXPECT_NEAR(correlation(base, other), 0, 5.0 / 64);
  }
}

/// Complex numbers of one row.
struct Field {
  std::vector<float> re, im;
  Field(RandomKey key, std::uint32_t row, int count)
      : re(static_cast<std::size_t>(count)), im(static_cast<std::size_t>(count)) {
    fill_complex_gaussian(key, row, count, re.data(), im.data());
  }
  double power(std::size_t i) const { return std::norm(std::complex<double>(value(i))); }
  std::complex<float> value(std::size_t i) const { return {re[i], im[i]}; }
};

/// As make_random_key() and fill_complex_gaussian() document, in double precision with library functions.
std::complex<double> plain_gaussian(RandomKey key, std::uint32_t row, std::uint32_t column) {
  std::uint64_t k = (key.value ^ row) + 0x9E3779B97F4A7C15U;
  k = (k ^ (k >> 30)) * 0xBF58476D1CE4E5B9U;
  k = (k ^ (k >> 27)) * 0x94D049BB133111EBU;
  k ^= k >> 31;
  std::uint32_t v[3] = {column * 1664525U + 1013904223U, static_cast<std::uint32_t>(k),
                        static_cast<std::uint32_t>(k >> 32)};
  const auto stir = [&v] {
    v[0] += v[1] * v[2];
    v[1] += v[2] * v[0];
    v[2] += v[0] * v[1];
  };
  stir();
  for (std::uint32_t& word : v) {
    word ^= word >> 16;
  }
  stir();
  const double u = (std::floor(v[0] / 2.0) + 0.5) / 0x1p31;
  // The lower 31 bits of the second word as a signed number span a half circle, the upper bit turns it round.
  const auto half = static_cast<double>(static_cast<std::int32_t>(v[1] << 1)) / 0x1p33;
  const double sign = v[1] >= 0x80000000U ? -1 : 1;
  return std::polar(std::sqrt(-std::log(u)), 2 * std::numbers::pi * half) * sign;
}

// Polynomials of single precision against the library: |z| reaches 4.7, so 1e-5 is a few roundings.
TEST(Random, AgreesWithPlainDoubleArithmetic) {
  const RandomKey key = make_random_key(3, 1, RandomField::noise, 4);
  double largest = 0;
  for (std::uint32_t row = 0; row < 100; ++row) {
    const Field field(key, row, 1000);
    for (std::size_t i = 0; i < 1000; ++i) {
      const auto error =
          std::complex<double>(field.value(i)) - plain_gaussian(key, row, static_cast<std::uint32_t>(i));
      largest = std::max(largest, std::abs(error));
    }
  }
  EXPECT_LT(largest, 1e-5);
}

double chi_square(const std::vector<int>& counts) {
  double total = 0;
  for (const int n : counts) {
    total += n;
  }
  const double expected = total / static_cast<double>(counts.size());
  double sum = 0;
  for (const int n : counts) {
    sum += (n - expected) * (n - expected) / expected;
  }
  return sum;
}

// exp(-|z|^2) and the phase are uniform, alone and together. Chi-square with n cells has mean n - 1 and
// standard deviation sqrt(2 (n - 1)); bounds are four of them on both sides, so that "too even" fails as
// well.
TEST(Random, AmplitudeAndPhaseAreUniform) {
  constexpr int cells = 64;
  for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{77}}) {
    const RandomKey key = make_random_key(seed, 0, RandomField::speckle, 1);
    std::vector<int> amplitude(cells), phase(cells), both(cells * cells);
    for (std::uint32_t row = 0; row < 2000; ++row) {
      const Field field(key, row, 256);
      for (std::size_t i = 0; i < 256; ++i) {
        const double turn = 0.5 + std::arg(field.value(i)) / (2 * std::numbers::pi);
        const auto a =
            std::min<std::size_t>(cells - 1, static_cast<std::size_t>(cells * std::exp(-field.power(i))));
        const auto p = std::min<std::size_t>(cells - 1, static_cast<std::size_t>(cells * turn));
        ++amplitude[a];
        ++phase[p];
        ++both[a * cells + p];
      }
    }
    for (const std::vector<int>* counts : {&amplitude, &phase, &both}) {
      const auto freedom = static_cast<double>(counts->size() - 1);
      EXPECT_NEAR(chi_square(*counts), freedom, 4 * std::sqrt(2 * freedom));
    }
  }
}

/// Correlation of two fields of n numbers in standard errors: of the complex values, and of the powers
/// (variance 1), which shows dependence that phases hide.
struct Correlation {
  std::complex<double> field;
  double power = 0;
  int count = 0;

  void add(const Field& a, std::size_t i, const Field& b, std::size_t j) {
    field += std::complex<double>(a.value(i)) * std::conj(std::complex<double>(b.value(j)));
    power += (a.power(i) - 1) * (b.power(j) - 1);
    ++count;
  }
  void expect_none(const char* what) const {
    const double root = std::sqrt(count);
    EXPECT_LT(std::abs(field.real()) / root, 3 * std::sqrt(0.5)) << what;
    EXPECT_LT(std::abs(field.imag()) / root, 3 * std::sqrt(0.5)) << what;
    EXPECT_LT(std::abs(power) / root, 3) << what;
  }
};

TEST(Random, NeighboursInAnyDirectionAreUnrelated) {
  constexpr int columns = 1024;
  constexpr std::uint32_t rows = 500;
  const auto key = [](std::uint64_t seed, int stream, RandomField field, std::uint64_t ping) {
    return make_random_key(seed, stream, field, ping);
  };
  const RandomKey base = key(1, 0, RandomField::noise, 10);
  Correlation column, far_column, row, ping, seed, stream, field;
  for (std::uint32_t r = 0; r < rows; ++r) {
    const Field here(base, r, columns);
    const Field below(base, r + 1, columns);
    const Field next_ping(key(1, 0, RandomField::noise, 11), r, columns);
    const Field next_seed(key(2, 0, RandomField::noise, 10), r, columns);
    const Field next_stream(key(1, 1, RandomField::noise, 10), r, columns);
    const Field other_field(key(1, 0, RandomField::speckle, 10), r, columns);
    for (std::size_t i = 0; i + 16 < columns; ++i) {
      column.add(here, i, here, i + 1);
      far_column.add(here, i, here, i + 16);  // the next vector
      row.add(here, i, below, i);
      ping.add(here, i, next_ping, i);
      seed.add(here, i, next_seed, i);
      stream.add(here, i, next_stream, i);
      field.add(here, i, other_field, i);
    }
  }
  column.expect_none("columns");
  far_column.expect_none("columns 16 apart");
  row.expect_none("rows");
  ping.expect_none("pings");
  seed.expect_none("seeds");
  stream.expect_none("streams");
  field.expect_none("fields");
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
TEST(BeamKernel, GivesTheCorrelationOfRealHeads) {
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

// Against the sum written out, for kernels shorter and longer than one pass of the filter.
TEST(BeamFilter, IsTheSumOverTheKernel) {
  for (const int half : {0, 1, 3, 4, 7, 16}) {
    std::vector<float> kernel;
    for (int j = -half; j <= half; ++j) {
      kernel.push_back(1.0F / static_cast<float>(1 + j * j));
    }
    const BeamFilter filter(kernel, 21);
    const int reach = (filter.row_width() - 21) / 2;
    ASSERT_GE(reach, half);
    const Field row(make_random_key(1, 0, RandomField::noise, 0), 0, filter.row_width());
    std::vector<float> out(21);
    filter.apply(row.re.data(), out.data());
    for (int b = 0; b < 21; ++b) {
      double sum = 0;
      for (int j = -half; j <= half; ++j) {
        sum += static_cast<double>(kernel[static_cast<std::size_t>(j + half)]) *
               static_cast<double>(row.re[static_cast<std::size_t>(b + reach + j)]);
      }
      EXPECT_NEAR(out[static_cast<std::size_t>(b)], sum, 1e-5);
    }
  }
}

}  // namespace
}  // namespace sonard::render
