// SPDX-License-Identifier: Apache-2.0
#include "protocol/common/linear_samples.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace sonard {
namespace {

TEST(LinearSamples, ASquareRootIsSquared) {
  std::vector<std::uint8_t> samples{0, 16, 128, 254, 255};
  make_linear(samples, 0.5);
  EXPECT_EQ(samples, (std::vector<std::uint8_t>{0, 1, 64, 253, 255}));  // 255 (x / 255)^2
}

TEST(LinearSamples, AmplitudesStayAsTheyAre) {
  std::vector<std::uint8_t> samples{0, 1, 77, 254, 255};
  make_linear(samples, 1.0);
  EXPECT_EQ(samples, (std::vector<std::uint8_t>{0, 1, 77, 254, 255}));
}

}  // namespace
}  // namespace sonard
