// SPDX-License-Identifier: Apache-2.0
// Pictures in the folder, identified by their brightness, when several are written under one name.
#include "clients/sonarview/common/image_writer.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <future>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/temporary_folder.hpp"

namespace sonard::client {
namespace {

namespace fs = std::filesystem;

Picture grey(int brightness) {
  return {"fan-last.png", [brightness] { return cv::Mat(2, 2, CV_8UC1, cv::Scalar(brightness)); }};
}

int brightness_of(const fs::path& file) {
  const cv::Mat image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  return image.empty() ? -1 : image.at<unsigned char>(0, 0);
}

TEST(ImageWriter, NothingButWholePicturesIsLeft) {
  const test::TemporaryFolder folder;
  ImageWriter writer(folder.path());
  writer.write({grey(10)});
  writer.write({grey(20)});
  writer.finish();
  EXPECT_EQ(writer.written(), 2U);
  EXPECT_EQ(brightness_of(folder.path() / "fan-last.png"), 20);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

TEST(ImageWriter, TheOldPictureStandsWhileTheNextIsDrawn) {
  const test::TemporaryFolder folder;
  ImageWriter writer(folder.path());
  writer.write({grey(10)});
  std::promise<void> drawing, looked;
  writer.write({{"fan-last.png", [&] {
                   drawing.set_value();
                   looked.get_future().wait_for(std::chrono::seconds{30});
                   return cv::Mat(2, 2, CV_8UC1, cv::Scalar(20));
                 }}});
  ASSERT_EQ(drawing.get_future().wait_for(std::chrono::seconds{30}), std::future_status::ready);
  EXPECT_EQ(brightness_of(folder.path() / "fan-last.png"), 10);
  looked.set_value();
  writer.finish();
  EXPECT_EQ(brightness_of(folder.path() / "fan-last.png"), 20);
}

TEST(ImageWriter, ARefreshIsDrawnButNotCountedAndNeverReplacesWhatCameLater) {
  const test::TemporaryFolder folder;
  {
    ImageWriter writer(folder.path());
    writer.refresh({grey(10)});
    writer.finish();
    EXPECT_EQ(writer.written(), 0U);
    EXPECT_EQ(brightness_of(folder.path() / "fan-last.png"), 10);
  }
  ImageWriter writer(folder.path());
  writer.refresh({grey(30)});
  writer.write({grey(40)});
  writer.finish();
  EXPECT_EQ(writer.written(), 1U);
  EXPECT_EQ(brightness_of(folder.path() / "fan-last.png"), 40);
}

TEST(ImageWriter, AFolderThatVanishesIsReported) {
  const test::TemporaryFolder folder;
  ImageWriter writer(folder.path() / "gone");
  fs::remove(folder.path() / "gone");
  writer.write({grey(10)});
  writer.finish();
  EXPECT_EQ(writer.written(), 0U);
  EXPECT_NE(writer.error().find("fan-last.png"), std::string::npos) << writer.error();
}

}  // namespace
}  // namespace sonard::client
