// SPDX-License-Identifier: Apache-2.0
// Places of a sweep's lines in its pictures, against closed forms: a bearing of u units points
// (u - 3200) * 360 / 6400 degrees to starboard of ahead, which is up; bin k is at (k + 0.5) bin lengths.
#include "renderer/picture/sweep_image.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "renderer/picture/amber.hpp"

namespace sonard::picture {
namespace {

constexpr int bins = 200;
constexpr double bin_m = 0.05;  // 10 m
constexpr int disc_px = 400;    // two pixels a bin
constexpr FanStyle plain{.radius_px = disc_px, .grid = false};

SweepShape all_round(int step = 32) {
  return {.step = step, .bins = bins, .bin_m = bin_m};
}
SweepShape sector(int left, int width, int step = 32) {
  return {left, width, step, bins, bin_m};
}

double angle_rad(double units) {
  return (units - 3200.0) * 2.0 * std::numbers::pi / 6400.0;
}

SweepLine even_line(int bearing, std::uint8_t value) {
  return {bearing, std::vector<std::uint8_t>(bins, value)};
}
SweepLine one_bin(int bearing, int bin) {
  SweepLine line = even_line(bearing, 0);
  line.samples[static_cast<std::size_t>(bin)] = 255;
  return line;
}

cv::Point2d centre_of_mass(const cv::Mat& image) {
  const cv::Moments moments = cv::moments(image);
  return {moments.m10 / moments.m00, moments.m01 / moments.m00};
}

TEST(SweepImage, LabelsAreTakenFromTheNearestBin) {
  for (const int pixels : {disc_px, bins / 4}) {
    const SweepImage image(all_round(), {.radius_px = pixels, .grid = false});
    SweepLine line = even_line(3200, 0);
    std::fill(line.samples.begin() + 100, line.samples.begin() + 140, std::uint8_t{9});
    const cv::Mat labels = image.project({line}, Resampling::nearest).samples;
    // Straight ahead of the apex from 100 to 140 of 200 bins.
    for (const int bin : {90, 105, 120, 135, 150}) {
      const int value = labels.at<uchar>(pixels - bin * pixels / bins, pixels);
      EXPECT_EQ(value, bin >= 100 && bin < 140 ? 9 : 0) << bin;
    }
    EXPECT_EQ(cv::countNonZero(labels), cv::countNonZero(labels == 9));
  }
}

class BrightBin : public testing::TestWithParam<int> {};

TEST_P(BrightBin, AppearsAtItsBearingAndRange) {
  const int bearing = GetParam();
  const SweepImage image(all_round(), plain);
  const auto [samples, heard] = image.project({one_bin(bearing, 150)});
  ASSERT_EQ(samples.size(), cv::Size(2 * disc_px + 1, 2 * disc_px + 1));
  const double radius = 150.5 * disc_px / bins;
  const cv::Point2d expected{disc_px + radius * std::sin(angle_rad(bearing)),
                             disc_px - radius * std::cos(angle_rad(bearing))};
  const cv::Point2d found = centre_of_mass(samples);
  EXPECT_NEAR(found.x, expected.x, 0.7);
  EXPECT_NEAR(found.y, expected.y, 0.7);
  EXPECT_GT(samples.at<uchar>(cvRound(expected.y), cvRound(expected.x)), 120);
}

INSTANTIATE_TEST_SUITE_P(Bearings, BrightBin,
                         testing::Values(0, 16, 800, 1600, 3168, 3200, 3232, 4801, 5600, 6399));

TEST(SweepImage, AheadIsUpAndStarboardOnTheRight) {
  const SweepImage image(all_round(), plain);
  const cv::Mat ahead = image.project({even_line(3200, 200)}).samples;
  EXPECT_EQ(ahead.at<uchar>(disc_px - 100, disc_px), 200);
  EXPECT_EQ(ahead.at<uchar>(disc_px + 100, disc_px), 0);
  const cv::Mat starboard = image.project({even_line(4800, 200)}).samples;
  EXPECT_EQ(starboard.at<uchar>(disc_px, disc_px + 100), 200);
  EXPECT_EQ(starboard.at<uchar>(disc_px, disc_px - 100), 0);
}

/// Expects that a line fills half a step on either side of its bearing, out to the range, and nothing else.
void expect_wedge(const SweepImage& image, int bearing, int step) {
  const auto [samples, heard] = image.project({even_line(bearing, 177)});
  const double half_rad = step * std::numbers::pi / 6400.0;
  constexpr double rounding_rad = 1e-9;
  int filled = 0;
  for (int y = 0; y < samples.rows; ++y) {
    for (int x = 0; x < samples.cols; ++x) {
      const double dx = x - image.geometry().apex().x;
      const double dy = image.geometry().apex().y - y;
      const double off =
          std::abs(std::remainder(std::atan2(dx, dy) - angle_rad(bearing), 2.0 * std::numbers::pi));
      if (std::abs(off - half_rad) < rounding_rad || (dx == 0.0 && dy == 0.0)) {
        continue;  // on the edge
      }
      const bool inside = off < half_rad && std::hypot(dx, dy) < disc_px;
      ASSERT_EQ(heard.at<uchar>(y, x), inside ? 255 : 0) << x << ", " << y;
      ASSERT_EQ(samples.at<uchar>(y, x), inside ? 177 : 0) << x << ", " << y;
      filled += inside ? 1 : 0;
    }
  }
  EXPECT_GT(filled, 0.8 * half_rad * disc_px * disc_px);
}

TEST(SweepImage, ALineFillsItsOwnStepAndNothingElse) {
  const SweepImage image(all_round(), plain);
  for (const int bearing : {0, 40, 1616, 3200, 5000, 6390}) {
    expect_wedge(image, bearing, 32);
  }
}

TEST(SweepImage, AnOddStepIsCutInTheMiddleOfAUnit) {
  const SweepImage image(all_round(9), plain);
  expect_wedge(image, 3200, 9);
  expect_wedge(image, 4, 9);
}

TEST(SweepImage, TwoHundredStepsFillTheTurn) {
  const SweepImage image(all_round(), plain);
  std::vector<SweepLine> lines;
  for (int line = 0; line < 200; ++line) {
    lines.push_back(even_line((3200 + 32 * line) % 6400, static_cast<std::uint8_t>(line + 1)));
  }
  const auto [samples, heard] = image.project(lines);
  // All pixels with their centre within the circle, less than 400 px away from (400, 400).
  cv::Mat disc = cv::Mat::zeros(heard.size(), CV_8UC1);
  for (int y = 0; y < disc.rows; ++y) {
    for (int x = 0; x < disc.cols; ++x) {
      disc.at<uchar>(y, x) = std::hypot(x - 400, y - 400) < 400.0 ? 255 : 0;
    }
  }
  EXPECT_EQ(cv::countNonZero(disc != heard), 0);
  EXPECT_EQ(samples.at<uchar>(200, 400), 1);   // ahead
  EXPECT_EQ(samples.at<uchar>(400, 600), 51);  // a quarter on
  EXPECT_EQ(samples.at<uchar>(600, 400), 101);
  EXPECT_EQ(samples.at<uchar>(400, 200), 151);
}

TEST(SweepImage, OfTwoLinesTheLaterIsSeen) {
  const SweepImage image(all_round(), plain);
  const cv::Mat samples = image.project({even_line(3200, 50), even_line(3216, 90)}).samples;
  const auto at = [&](double units) {
    return samples.at<uchar>(cvRound(400 - 300 * std::cos(angle_rad(units))),
                             cvRound(400 + 300 * std::sin(angle_rad(units))));
  };
  EXPECT_EQ(at(3192), 50);
  EXPECT_EQ(at(3208), 90);  // the second line begins at 3200
  EXPECT_EQ(at(3224), 90);
}

TEST(SweepImage, ASectorIsAsLargeAsItsEdgesSay) {
  // 45 degrees to either side, and half a step of 1.8 degrees beyond.
  const SweepImage image(sector(2400, 1600), plain);
  const double edge_rad = 45.9 * std::numbers::pi / 180.0;
  EXPECT_NEAR(image.geometry().port_edge_rad(), -edge_rad, 1e-12);
  EXPECT_NEAR(image.geometry().starboard_edge_rad(), edge_rad, 1e-12);
  EXPECT_EQ(image.geometry().size(), cv::Size(2 * 288 + 1, 401));  // 400 sin 45.9 = 287.3
  expect_wedge(image, 2400, 32);
  expect_wedge(image, 3210, 32);
  expect_wedge(image, 4000, 32);
}

TEST(SweepImage, ASectorThroughAsternHangsDown) {
  // 3200 + 2880 is 162 degrees to starboard; 640 units on is 162 degrees to port.
  const SweepImage image(sector(6080, 640), plain);
  const double half_width = std::ceil(400.0 * std::sin(18.9 * std::numbers::pi / 180.0));
  EXPECT_EQ(image.geometry().size(), cv::Size(2 * static_cast<int>(half_width) + 1, 401));
  EXPECT_EQ(image.geometry().apex(), cv::Point2d(half_width, 0.0));
  expect_wedge(image, 6080, 32);
  expect_wedge(image, 0, 32);
  expect_wedge(image, 320, 32);
}

TEST(SweepImage, ASectorThatBeginsAtAsternIsNotCut) {
  const SweepImage image(sector(8, 1000), plain);  // its edge is half a step before, on the other side
  expect_wedge(image, 8, 32);
  expect_wedge(image, 1008, 32);
}

TEST(SweepImage, ASectorOfAllButAStepIsTheWholeCircle) {
  const SweepImage image(sector(16, 6368), plain);
  EXPECT_TRUE(image.geometry().full_circle());
  EXPECT_EQ(image.geometry().size(), cv::Size(801, 801));
  expect_wedge(image, 6384, 32);
}

TEST(SweepImage, OneOfManyFineBinsStaysVisible) {
  const SweepShape shape{0, 6400, 32, 1500, 0.0024};
  SweepLine line{3200, std::vector<std::uint8_t>(1500, 0)};
  line.samples[1000] = 255;
  const cv::Mat samples = SweepImage(shape, {.radius_px = 100, .grid = false}).project({line}).samples;
  double most = 0.0;
  cv::Point place;
  cv::minMaxLoc(samples.col(100), nullptr, &most, nullptr, &place);
  EXPECT_GT(most, 8.0);  // 255 over fifteen bins
  EXPECT_NEAR(100 - place.y, 1000.5 / 15.0, 1.0);
}

TEST(SweepImage, DrawsEchoesInThePaletteAndSilenceAsBackground) {
  const SweepImage image(all_round(), plain);
  const cv::Mat picture = image.draw({even_line(3200, 160)}, "");
  EXPECT_EQ(picture.at<cv::Vec3b>(200, 400), amber::palette(amber::Samples::decibels).at<cv::Vec3b>(0, 160));
  const cv::Scalar background = amber::background();
  EXPECT_EQ(picture.at<cv::Vec3b>(600, 400),
            cv::Vec3b(static_cast<uchar>(background[0]), static_cast<uchar>(background[1]),
                      static_cast<uchar>(background[2])));
}

TEST(SweepImage, RingsAreAtWholeRanges) {
  const SweepImage image(all_round(), {.radius_px = 500});
  const cv::Mat picture = image.draw({}, "caption");
  // Rings of 2 m over 10 m, looked for at 15 degrees, off the bearing lines.
  for (const double range_m : {2.0, 4.0, 6.0, 8.0}) {
    const auto brightness = [&](double at_m) {
      const cv::Point2d at = image.geometry().pixel(at_m, std::numbers::pi / 12.0);
      const cv::Vec3b bgr = picture.at<cv::Vec3b>(cvRound(at.y), cvRound(at.x));
      return bgr[0] + bgr[1] + bgr[2];
    };
    EXPECT_GT(brightness(range_m), brightness(range_m - 0.7) + 60) << range_m;
  }
}

TEST(SweepPolarImage, HasAColumnForEachStepAndAsternAtItsEdges) {
  const cv::Mat polar = sweep_polar_image(all_round(), {one_bin(3200, 0), one_bin(0, 7), one_bin(6368, 199)});
  ASSERT_EQ(polar.size(), cv::Size(200, bins));
  EXPECT_EQ(polar.at<uchar>(bins - 1, 100), 255);  // the nearest is at the bottom
  EXPECT_EQ(polar.at<uchar>(bins - 8, 0), 255);
  EXPECT_EQ(polar.at<uchar>(0, 199), 255);
  EXPECT_EQ(cv::countNonZero(polar), 3);
}

TEST(SweepPolarImage, ASectorHasItsLimitsAtItsEdges) {
  // 1590 units are 49.7 steps: the last step is shorter.
  const cv::Mat polar = sweep_polar_image(sector(6000, 1590), {one_bin(6000, 0), one_bin(1190, 1)});
  ASSERT_EQ(polar.size(), cv::Size(51, bins));
  EXPECT_EQ(polar.at<uchar>(bins - 1, 0), 255);
  EXPECT_EQ(polar.at<uchar>(bins - 2, 50), 255);
}

}  // namespace
}  // namespace sonard::picture
