// SPDX-License-Identifier: Apache-2.0
// Geometry of the fan against closed forms: bearing(b) = asin((2b + 1 - 256) / 256 * sin 60 deg),
// protocol/gemini/README.md 6.5; line i at (i + 0.5) steps; range up, port on the left.
#include "renderer/picture/fan_image.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <set>
#include <utility>

#include "protocol/gemini/bearings.hpp"
#include "renderer/picture/amber.hpp"
#include "renderer/picture/polar_grid.hpp"

namespace sonard::picture {
namespace {

constexpr int beams = 256;
constexpr int lines = 500;
constexpr double line_step_m = 0.04;  // 20 m
constexpr int radius_px = 1000;       // two pixels a line

FanShape shape() {
  return {gemini::bearings_rad(beams), lines, line_step_m};
}

double sine_of_beam(int beam) {
  return (2.0 * beam + 1.0 - beams) / beams * std::sin(std::numbers::pi / 3.0);
}

/// The samples with one bright cell.
cv::Mat one_cell(int line, int beam) {
  cv::Mat polar = cv::Mat::zeros(lines, beams, CV_8UC1);
  polar.at<uchar>(line, beam) = 255;
  return polar;
}

/// Centre of brightness, pixels.
cv::Point2d centroid(const cv::Mat& image) {
  const cv::Moments moments = cv::moments(image);
  return {moments.m10 / moments.m00, moments.m01 / moments.m00};
}

class BrightCell : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(BrightCell, AppearsWhereItsRangeAndBearingAre) {
  const auto [line, beam] = GetParam();
  const FanImage fan(shape(), {.radius_px = radius_px, .grid = false});
  const cv::Mat image = fan.project(one_cell(line, beam));
  ASSERT_GT(cv::countNonZero(image), 0);
  const double radius = (line + 0.5) * radius_px / lines;
  const double sine = sine_of_beam(beam);
  // The apex is at the bottom; the fan is symmetric, so the apex is in the middle.
  const double apex_x = (image.cols - 1) / 2.0;
  const double apex_y = image.rows - 1;
  const cv::Point2d expected{apex_x + radius * sine, apex_y - radius * std::sqrt(1.0 - sine * sine)};
  const cv::Point2d found = centroid(image);
  EXPECT_NEAR(found.x, expected.x, 0.7);
  EXPECT_NEAR(found.y, expected.y, 0.7);
  const cv::Point brightest{cvRound(expected.x), cvRound(expected.y)};
  EXPECT_GT(image.at<uchar>(brightest), 100);
}

INSTANTIATE_TEST_SUITE_P(Cells, BrightCell,
                         testing::Values(std::pair{450, 0}, std::pair{450, 1}, std::pair{480, 64},
                                         std::pair{300, 127}, std::pair{300, 128}, std::pair{480, 191},
                                         std::pair{250, 100}, std::pair{450, 254}, std::pair{450, 255}));

// Labels are not mixed, and lie at their samples, even if lines are finer than pixels.
TEST(FanImage, LabelsAreTakenFromTheNearestSample) {
  for (const int pixels : {radius_px, lines / 5}) {
    const FanImage image(shape(), {.radius_px = pixels, .grid = false});
    cv::Mat labels = cv::Mat::zeros(lines, beams, CV_8UC1);
    labels(cv::Rect(180, 200, 20, 100)).setTo(3);
    labels(cv::Rect(200, 200, 20, 100)).setTo(7);
    const cv::Mat fan = image.project(labels, Resampling::nearest);
    EXPECT_EQ(std::set<uchar>(fan.begin<uchar>(), fan.end<uchar>()), (std::set<uchar>{0, 3, 7}));
    // Beams 180 to 199, lines 200 to 299 are an even sector of 8 to 12 m.
    double bearing_rad = 0, range_m = 0;
    int count = 0;
    for (int y = 0; y < fan.rows; ++y) {
      for (int x = 0; x < fan.cols; ++x) {
        if (fan.at<uchar>(y, x) == 3) {
          bearing_rad += image.geometry().bearing_at({static_cast<double>(x), static_cast<double>(y)});
          range_m += image.geometry().range_at({static_cast<double>(x), static_cast<double>(y)});
          ++count;
        }
      }
    }
    const double middle_rad = (std::asin(sine_of_beam(180)) + std::asin(sine_of_beam(199))) / 2;
    EXPECT_NEAR(bearing_rad / count, middle_rad, 0.01) << pixels;
    EXPECT_NEAR(range_m / count, 2.0 / 3 * (12.0 * 12 * 12 - 8 * 8 * 8) / (12.0 * 12 - 8 * 8), 0.1)
        << "of an annulus";
  }
}

TEST(FanImage, PortIsOnTheLeft) {
  const FanImage fan(shape(), {.radius_px = 400, .grid = false});
  const cv::Mat image = fan.project(one_cell(400, 20));
  EXPECT_LT(centroid(image).x, fan.geometry().apex().x - 200.0);
}

TEST(FanImage, EqualAnglesWouldPutABeamElsewhere) {
  // Beam 64 points to -25.44 degrees; with equal angles over +-60 degrees it would be -29.77.
  const FanGeometry geometry(shape(), radius_px, 0);
  const double bearing_rad = std::asin(sine_of_beam(64));
  EXPECT_NEAR(bearing_rad * 180.0 / std::numbers::pi, -25.44, 0.01);
  EXPECT_NEAR(geometry.beam_at(bearing_rad), 64.0, 1e-9);
}

TEST(FanGeometry, EveryBeamIsAtItsBearingAndInvertsItsPixel) {
  const FanGeometry geometry(shape(), radius_px, 10);
  for (int beam = 0; beam < beams; ++beam) {
    const double bearing_rad = std::asin(sine_of_beam(beam));
    const cv::Point2d pixel = geometry.pixel(12.5, bearing_rad);
    EXPECT_NEAR(geometry.range_at(pixel), 12.5, 1e-9);
    EXPECT_NEAR(geometry.beam_at(geometry.bearing_at(pixel)), beam, 1e-6);
  }
}

TEST(FanGeometry, EndsHalfABeamBeyondTheOuterBeams) {
  const FanGeometry geometry(shape(), radius_px, 0);
  const double first = std::asin(sine_of_beam(0));
  const double second = std::asin(sine_of_beam(1));
  EXPECT_NEAR(geometry.port_edge_rad(), first - (second - first) / 2.0, 1e-12);
  EXPECT_NEAR(geometry.starboard_edge_rad(), -geometry.port_edge_rad(), 1e-12);
  EXPECT_FALSE(std::isnan(geometry.beam_at(geometry.port_edge_rad() + 1e-9)));
  EXPECT_TRUE(std::isnan(geometry.beam_at(geometry.port_edge_rad() - 1e-9)));
  EXPECT_TRUE(std::isnan(geometry.beam_at(std::numbers::pi)));
}

TEST(FanImage, FillsTheFanAndNothingElse) {
  const FanImage fan(shape(), {.radius_px = 300, .grid = false});
  const cv::Mat image = fan.project(cv::Mat(lines, beams, CV_8UC1, cv::Scalar(200)));
  const auto& geometry = fan.geometry();
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double dx = x - geometry.apex().x;
      const double dy = geometry.apex().y - y;
      const double bearing_rad = std::atan2(dx, dy);
      const bool inside =
          std::hypot(dx, dy) < 300.0 && std::abs(bearing_rad) <= geometry.starboard_edge_rad();
      ASSERT_EQ(image.at<uchar>(y, x), inside ? 200 : 0) << x << ", " << y;
    }
  }
}

TEST(FanImage, OneLineOfManyStaysVisible) {
  constexpr int many = 7234;  // 60 m without compression, eighteen lines a pixel
  const FanImage fan({gemini::bearings_rad(beams), many, 0.0083}, {.radius_px = 400, .grid = false});
  cv::Mat polar = cv::Mat::zeros(many, beams, CV_8UC1);
  polar.row(5000).setTo(255);
  const cv::Mat image = fan.project(polar);
  const double radius = 5000.5 / many * 400.0;
  const int x = cvRound(fan.geometry().apex().x);
  int best_y = 0;
  for (int y = 0; y < image.rows; ++y) {
    best_y = image.at<uchar>(y, x) > image.at<uchar>(best_y, x) ? y : best_y;
  }
  EXPECT_GT(image.at<uchar>(best_y, x), 4);
  EXPECT_NEAR(fan.geometry().apex().y - best_y, radius, 1.0);
}

TEST(FanImage, DrawsEchoesInThePaletteOnTheBackground) {
  const FanImage fan(shape(), {.radius_px = 300, .grid = false});
  const cv::Mat picture = fan.draw(cv::Mat(lines, beams, CV_8UC1, cv::Scalar(160)), "");
  const cv::Mat palette = amber::palette(amber::Samples::amplitudes);
  EXPECT_EQ(picture.at<cv::Vec3b>(150, picture.cols / 2), palette.at<cv::Vec3b>(0, 160));
  const cv::Scalar background = amber::background();
  EXPECT_EQ(picture.at<cv::Vec3b>(0, 0),
            cv::Vec3b(static_cast<uchar>(background[0]), static_cast<uchar>(background[1]),
                      static_cast<uchar>(background[2])));
}

TEST(FanImage, TheGridIsDrawnAtWholeRanges) {
  const FanImage plain(shape(), {.radius_px = 500, .grid = true});
  const cv::Mat picture = plain.draw(cv::Mat::zeros(lines, beams, CV_8UC1), "caption");
  const auto& geometry = plain.geometry();
  // Rings of 5 m over 20 m, looked for at 10 degrees, off the bearing lines.
  for (const double range_m : {5.0, 10.0, 15.0, 20.0}) {
    const cv::Point2d on = geometry.pixel(range_m, 10.0 * std::numbers::pi / 180.0);
    const cv::Point2d off = geometry.pixel(range_m - 1.3, 10.0 * std::numbers::pi / 180.0);
    const auto brightness = [&](cv::Point2d at) {
      const cv::Vec3b bgr = picture.at<cv::Vec3b>(cvRound(at.y), cvRound(at.x));
      return bgr[0] + bgr[1] + bgr[2];
    };
    EXPECT_GT(brightness(on), brightness(off) + 60) << range_m;
  }
}

TEST(FanImage, TheGridOfANarrowFanIsFinerAndHasNoBearingsOutsideOfIt) {
  const auto drawn_at = [](double half_deg, double bearing_deg) {
    FanShape fan{{}, lines, line_step_m};
    for (int beam = 0; beam < beams; ++beam) {
      fan.bearings_rad.push_back((2.0 * beam / (beams - 1) - 1) * half_deg * std::numbers::pi / 180);
    }
    const FanImage image(fan, {.radius_px = radius_px});
    const cv::Mat empty = image.draw(cv::Mat::zeros(lines, beams, CV_8UC1), "");
    const cv::Point at = image.geometry().pixel(16.0, bearing_deg * std::numbers::pi / 180);
    const cv::Mat around = empty(cv::Rect(at.x - 1, at.y - 1, 3, 3)).clone();
    const cv::Mat ground = amber::paint(cv::Mat::zeros(3, 3, CV_8UC1), amber::Samples::amplitudes,
                                        cv::Mat(3, 3, CV_8UC1, cv::Scalar(255)));
    return cv::norm(around, ground, cv::NORM_INF) > 0;
  };
  EXPECT_TRUE(drawn_at(35, 20));
  EXPECT_FALSE(drawn_at(35, 25));
  EXPECT_FALSE(drawn_at(65, 20));
  EXPECT_TRUE(drawn_at(65, 60));
}

TEST(Palette, GrowsBrighterWithTheEcho) {
  const cv::Mat palette = amber::palette(amber::Samples::decibels);
  double last = -1.0;
  for (int value = 0; value < 256; ++value) {
    const cv::Vec3b bgr = palette.at<cv::Vec3b>(0, value);
    const double luma = 0.114 * bgr[0] + 0.587 * bgr[1] + 0.299 * bgr[2];
    EXPECT_GE(luma, last) << value;
    last = luma;
  }
  EXPECT_GT(last, 230.0);
}

TEST(RingStep, IsRoundAndNotTooFine) {
  EXPECT_DOUBLE_EQ(ring_step_m(20.0), 5.0);
  EXPECT_DOUBLE_EQ(ring_step_m(10.0), 2.0);
  EXPECT_DOUBLE_EQ(ring_step_m(4.0), 0.5);
  EXPECT_DOUBLE_EQ(ring_step_m(1.0), 0.2);
  EXPECT_DOUBLE_EQ(ring_step_m(60.0), 10.0);
  EXPECT_DOUBLE_EQ(ring_step_m(150.0), 20.0);
}

TEST(RawPolar, HasRangeUpwards) {
  const cv::Mat image = raw_polar_image(one_cell(0, 3));
  EXPECT_EQ(image.at<uchar>(lines - 1, 3), 255);
  EXPECT_EQ(cv::countNonZero(image), 1);
}

}  // namespace
}  // namespace sonard::picture
