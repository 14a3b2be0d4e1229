// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/speckle_field.hpp"

#include <cmath>
#include <complex>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/acoustics/random.hpp"

namespace sonard::render {
namespace {

constexpr int field_beams = 512;
constexpr int field_lines = 200;
constexpr double numbers = field_beams * field_lines;

/// Innovations are white here; the field accepts any.
void bring_up_to_date(SpeckleField& field, int line, std::uint64_t ping) {
  if (field.is_current(line)) {
    return;
  }
  std::vector<float> re(field_beams), im(field_beams);
  fill_complex_gaussian(make_random_key(1, 0, RandomField::speckle, ping), static_cast<std::uint32_t>(line),
                        field_beams, re.data(), im.data());
  field.evolve(line, re.data(), im.data());
}

void bring_all_up_to_date(SpeckleField& field, std::uint64_t ping) {
  for (int line = 0; line < field_lines; ++line) {
    bring_up_to_date(field, line, ping);
  }
}

using Values = std::vector<std::complex<double>>;

Values values_of(const SpeckleField& field) {
  Values values;
  for (int line = 0; line < field_lines; ++line) {
    for (int b = 0; b < field_beams; ++b) {
      values.emplace_back(static_cast<double>(field.real(line)[b]),
                          static_cast<double>(field.imaginary(line)[b]));
    }
  }
  return values;
}

double correlation(const Values& a, const Values& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += (a[i] * std::conj(b[i])).real();
  }
  return sum / static_cast<double>(a.size());
}

// Standard errors of n CN(0, 1): of E|z|^2, 1 / sqrt(n); of the correlation rho, less than 1 / sqrt(n).
const double field_bound = 4 / std::sqrt(numbers);

TEST(SpeckleField, IsUntouchedAtRest) {
  SpeckleField field(field_beams);
  field.ensure_lines(field_lines);
  EXPECT_FALSE(field.is_current(0));
  bring_all_up_to_date(field, 0);
  const Values first = values_of(field);
  EXPECT_NEAR(correlation(first, first), 1, field_bound);
  field.fade(0);
  EXPECT_TRUE(field.is_current(0));
  bring_all_up_to_date(field, 1);
  EXPECT_EQ(values_of(field), first);
}

TEST(SpeckleField, FadesByTheDecayAndKeepsItsPower) {
  for (const double decay : {1e-6, 0.1, 1.0, 3.0}) {
    SpeckleField field(field_beams);
    field.ensure_lines(field_lines);
    bring_all_up_to_date(field, 0);
    const Values first = values_of(field);
    field.fade(decay);
    bring_all_up_to_date(field, 1);
    const Values faded = values_of(field);
    EXPECT_NEAR(correlation(faded, faded), 1, field_bound);
    EXPECT_NEAR(correlation(first, faded), std::exp(-decay), field_bound);
    // Small steps are resolved too: the loss 1 - rho shows in the difference |a - b|^2 = 2 (1 - rho).
    double difference = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
      difference += std::norm(first[i] - faded[i]);
    }
    const double expected = 2 * (1 - std::exp(-decay));
    EXPECT_NEAR(difference / numbers, expected, 2 * field_bound * expected);
  }
}

TEST(SpeckleField, ManySmallStepsAddUp) {
  SpeckleField field(field_beams);
  field.ensure_lines(field_lines);
  bring_all_up_to_date(field, 0);
  const Values first = values_of(field);
  for (std::uint64_t ping = 1; ping <= 200; ++ping) {
    field.fade(0.005);
    bring_all_up_to_date(field, ping);
  }
  const Values last = values_of(field);
  EXPECT_NEAR(correlation(last, last), 1, field_bound);
  EXPECT_NEAR(correlation(first, last), std::exp(-1), field_bound);
}

// Unused lines catch up in one step, with the correlations that single steps give.
TEST(SpeckleField, SkippedStepsAreExactInDistribution) {
  SpeckleField eager(field_beams);
  SpeckleField lazy(field_beams);
  for (SpeckleField* field : {&eager, &lazy}) {
    field->ensure_lines(field_lines);
    bring_all_up_to_date(*field, 0);
  }
  const Values first = values_of(eager);
  EXPECT_EQ(first, values_of(lazy));
  double decay = 0;
  for (std::uint64_t ping = 1; ping <= 5; ++ping) {
    decay += 0.1 * static_cast<double>(ping);
    eager.fade(0.1 * static_cast<double>(ping));
    lazy.fade(0.1 * static_cast<double>(ping));
    bring_all_up_to_date(eager, ping);
    for (int line = 0; line < field_lines; line += 2) {
      bring_up_to_date(lazy, line, ping);
    }
  }
  EXPECT_FALSE(lazy.is_current(1));
  bring_all_up_to_date(lazy, 6);
  const Values a = values_of(eager);
  const Values b = values_of(lazy);
  EXPECT_NEAR(correlation(b, b), 1, field_bound);
  EXPECT_NEAR(correlation(first, a), std::exp(-decay), field_bound);
  EXPECT_NEAR(correlation(first, b), std::exp(-decay), field_bound);
  for (std::size_t i = 0; i < field_beams; ++i) {
    EXPECT_EQ(a[i], b[i]);  // line 0 missed nothing
  }
}

TEST(SpeckleField, LongWaysLeaveNothing) {
  SpeckleField field(field_beams);
  field.ensure_lines(field_lines);
  bring_all_up_to_date(field, 0);
  const Values first = values_of(field);
  field.fade(1e300);
  bring_all_up_to_date(field, 1);
  EXPECT_NEAR(correlation(first, values_of(field)), 0, field_bound);
  EXPECT_NEAR(correlation(values_of(field), values_of(field)), 1, field_bound);
}

TEST(SpeckleField, LinesSurviveAShorterRange) {
  SpeckleField field(field_beams);
  field.ensure_lines(field_lines);
  bring_all_up_to_date(field, 0);
  const Values first = values_of(field);
  field.ensure_lines(10);
  field.ensure_lines(field_lines);
  EXPECT_EQ(values_of(field), first);
}

}  // namespace
}  // namespace sonard::render
