// SPDX-License-Identifier: Apache-2.0
// Picture files against the reader of OpenCV.
#include "renderer/picture/picture_file.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

namespace sonard::picture {
namespace {

cv::Mat noise(int width, int height, int type) {
  cv::Mat picture(height, width, type);
  cv::randu(picture, 0, CV_MAT_DEPTH(type) == CV_16U ? 65'536 : 256);
  return picture;
}

cv::Mat smooth(int width, int height) {
  cv::Mat picture = noise(width, height, CV_8UC3);
  cv::GaussianBlur(picture, picture, {0, 0}, 8);
  return picture;
}

cv::Mat read_by_opencv(const std::string& file, int flags) {
  return cv::imdecode(std::vector<std::uint8_t>(file.begin(), file.end()), flags);
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(PictureFile, APngHoldsEveryPixel) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4}) {
    for (const int level : {1, 3, 9}) {
      const cv::Mat picture = noise(37, 19, type);
      EXPECT_TRUE(same(read_by_opencv(png_file(picture, level), cv::IMREAD_UNCHANGED), picture))
          << type << " " << level;
    }
  }
}

TEST(PictureFile, APartOfAPictureIsWrittenByItsRows) {
  const cv::Mat part = noise(40, 30, CV_8UC3)(cv::Rect(5, 6, 20, 10));
  EXPECT_TRUE(same(read_by_opencv(png_file(part, 1), cv::IMREAD_UNCHANGED), part));
  EXPECT_TRUE(same(read_by_opencv(jpeg_file(part, 80), cv::IMREAD_COLOR),
                   read_by_opencv(jpeg_file(part.clone(), 80), cv::IMREAD_COLOR)));
}

TEST(PictureFile, AJpegIsCloseByItsQuality) {
  const cv::Mat picture = smooth(120, 80);
  double before_db = 20;
  for (const int quality : {20, 80, 95}) {
    const cv::Mat read = read_by_opencv(jpeg_file(picture, quality), cv::IMREAD_COLOR);
    ASSERT_EQ(read.size(), picture.size());
    const double db = cv::PSNR(read, picture);
    EXPECT_GT(db, before_db) << quality;
    before_db = db;
  }
}

TEST(PictureFile, SaysWhatCannotBeWritten) {
  EXPECT_THROW(jpeg_file(cv::Mat(1, 70'000, CV_8UC3), 80), std::runtime_error);
  EXPECT_THROW(png_file(cv::Mat(1, 1'000'001, CV_8UC1), 1), std::runtime_error);
  EXPECT_THROW(png_file(cv::Mat(2, 2, CV_32FC1), 1), std::invalid_argument);
}

}  // namespace
}  // namespace sonard::picture
