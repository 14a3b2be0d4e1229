// SPDX-License-Identifier: Apache-2.0
// write_png()'s files, read by OpenCV.
#include "tests/pictures/png_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "renderer/picture/amber.hpp"
#include "tests/support/temporary_folder.hpp"

namespace sonard::pictures {
namespace {

TEST(PngFile, KeepsTheColoursOfPictures) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "picture.png";
  // The whole palette, and colours between ground and labels: within half a step of 6 codes.
  cv::Mat picture(3, 256, CV_8UC3);
  picture::amber::palette(picture::amber::Samples::decibels).copyTo(picture.row(0));
  for (int x = 0; x < 256; ++x) {
    const double part = x / 255.0;
    const cv::Scalar label = picture::amber::background() * (1 - part) + picture::amber::label() * part;
    const cv::Scalar grid = picture::amber::background() * (1 - part) + picture::amber::grid() * part;
    picture.at<cv::Vec3b>(1, x) =
        cv::Vec3b(cv::saturate_cast<uchar>(label[0]), cv::saturate_cast<uchar>(label[1]),
                  cv::saturate_cast<uchar>(label[2]));
    picture.at<cv::Vec3b>(2, x) =
        cv::Vec3b(cv::saturate_cast<uchar>(grid[0]), cv::saturate_cast<uchar>(grid[1]),
                  cv::saturate_cast<uchar>(grid[2]));
  }
  write_png(file, picture);
  const cv::Mat read = cv::imread(file.string());
  ASSERT_EQ(read.size(), picture.size());
  EXPECT_LE(cv::norm(read.row(0), picture.row(0), cv::NORM_INF), 12);
  EXPECT_LE(cv::norm(read.rowRange(1, 3), picture.rowRange(1, 3), cv::NORM_INF), 3);
}

TEST(PngFile, WidthsAndHeightsOfAnySize) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "picture.png";
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(7, 3), cv::Size(1, 300), cv::Size(1594, 2)}) {
    cv::Mat picture(size, CV_8UC3, picture::amber::background());
    picture.at<cv::Vec3b>(size.height - 1, size.width - 1) =
        picture::amber::palette(picture::amber::Samples::decibels).at<cv::Vec3b>(0, 254);
    write_png(file, picture);
    EXPECT_EQ(cv::norm(cv::imread(file.string()), picture, cv::NORM_INF), 0) << size;
  }
}

TEST(PngFile, NamesAFileThatCannotBeWritten) {
  EXPECT_THROW(write_png("/no/such/folder/picture.png", cv::Mat(1, 1, CV_8UC3)), std::runtime_error);
}

}  // namespace
}  // namespace sonard::pictures
