// SPDX-License-Identifier: Apache-2.0
// Profiles of different scans in one picture.
#include "clients/sonarview/ping1d/waterfall.hpp"

#include <gtest/gtest.h>

namespace sonard::client {
namespace {

ping1d::ReceivedPing ping(std::uint32_t start_mm, std::uint32_t length_mm, std::size_t bright_point) {
  ping1d::ReceivedPing ping;
  ping.measured = {.distance_mm = 2000,
                   .confidence_percent = 98,
                   .scan_start_mm = start_mm,
                   .scan_length_mm = length_mm,
                   .gain_setting = 1};
  ping.profile.resize(200);
  ping.profile[bright_point] = 255;
  return ping;
}

/// The first bright row of a column counted from the right; -1: none.
int bright_row(const cv::Mat& samples, int from_right) {
  for (int row = 0; row < samples.rows; ++row) {
    if (samples.at<std::uint8_t>(row, samples.cols - 1 - from_right) == 255) {
      return row;
    }
  }
  return -1;
}

TEST(Waterfall, EachPingIsAtItsRangeInTheLongestScan) {
  Waterfall waterfall(400);
  EXPECT_TRUE(waterfall.empty());
  waterfall.add(ping(0, 5000, 80));     // 2 m
  waterfall.add(ping(0, 10'000, 40));   // 2 m
  waterfall.add(ping(1000, 4000, 50));  // 2 m
  const cv::Mat samples = waterfall.samples();
  for (int from_right = 0; from_right < 3; ++from_right) {
    EXPECT_NEAR(bright_row(samples, from_right), 400 * 2 / 10, 1) << from_right;
  }
  EXPECT_EQ(bright_row(samples, 3), -1);
  const cv::Mat picture = waterfall.draw();
  EXPECT_GT(picture.rows, samples.rows);
  EXPECT_GT(picture.cols, samples.cols);
}

TEST(Waterfall, OldPingsLeaveThePicture) {
  Waterfall waterfall(100);
  for (int i = 0; i < 1000; ++i) {
    waterfall.add(ping(0, 5000, i < 500 ? 80 : 160));
  }
  const cv::Mat samples = waterfall.samples();
  EXPECT_NEAR(bright_row(samples, samples.cols - 1), 80, 1);
}

TEST(Waterfall, AnEmptyOrDamagedProfileDrawsNothing) {
  Waterfall waterfall(100);
  waterfall.add({});
  ping1d::ReceivedPing endless = ping(0xFFFFFFFF, 0xFFFFFFFF, 0);
  waterfall.add(endless);
  EXPECT_EQ(bright_row(waterfall.samples(), 1), -1);
  EXPECT_FALSE(waterfall.draw().empty());
}

TEST(Waterfall, TheCaptionTellsTheMeasurement) {
  EXPECT_EQ(measurement_text(ping(500, 4000, 0).measured),
            "distance 2.000 m   confidence 98 %   scan 0.50 to 4.50 m   gain 1");
}

}  // namespace
}  // namespace sonard::client
