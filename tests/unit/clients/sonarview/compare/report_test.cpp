// SPDX-License-Identifier: Apache-2.0
// Output and files of `sonarview compare`, and its errors.
#include "clients/sonarview/compare/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string>

namespace sonard::client {
namespace {

using testing::HasSubstr;

class Report : public testing::Test {
 protected:
  Report() { std::filesystem::create_directories(folder_); }
  ~Report() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string flat(const std::string& name, int width, int height, int value) const {
    cv::imwrite(path(name), cv::Mat(height, width, CV_8UC1, cv::Scalar(value)));
    return path(name);
  }

 private:
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) /
                                  testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(Report, TableAndFile) {
  // Flat images, 100 against 150: MSE 2500, PSNR 14.1514 dB, no keypoints. They are too small for five
  // scales.
  const CompareOptions options{flat("a.png", 64, 48, 100), flat("b.png", 64, 48, 150), path("out.json")};
  testing::internal::CaptureStdout();
  EXPECT_EQ(compare(options), ExitStatus::ok);
  EXPECT_EQ(testing::internal::GetCapturedStdout(),
            "measure              value         score  identical\n"
            "MSE              2500.0000        0.0384          0\n"
            "PSNR               14.1514 dB     0.1429          1\n"
            "SSIM                0.9231        0.9231          1\n"
            "MS-SSIM                  -             -          1\n"
            "SIFT distance            -             -          0\n");
  std::ostringstream written;
  written << std::ifstream(options.json).rdbuf();
  const nlohmann::json json = nlohmann::json::parse(written.str());
  EXPECT_EQ(json["a"], options.a);
  EXPECT_EQ(json["b"], options.b);
  EXPECT_EQ(json["width"], 64);
  EXPECT_EQ(json["height"], 48);
  ASSERT_EQ(json["measures"].size(), 5U);
  EXPECT_EQ(json["measures"][0]["value"], 2500.0);
  const nlohmann::json& psnr = json["measures"][1];
  EXPECT_EQ(psnr["name"], "psnr");
  EXPECT_NEAR(psnr["value"].get<double>(), 14.151403522, 1e-9);
  EXPECT_EQ(psnr["unit"], "dB");
  EXPECT_NEAR(psnr["score"].get<double>(), 0.142943470, 1e-9);
  EXPECT_EQ(psnr["identical"], 1);
  EXPECT_EQ(
      json["measures"][3],
      (nlohmann::json{
          {"name", "ms_ssim"}, {"value", nullptr}, {"unit", ""}, {"score", nullptr}, {"identical", 1}}));
}

TEST_F(Report, NamesThatNeedQuoting) {
  EXPECT_THAT(json_of({}, {"a\"b\\c\n", "b", ""}, 1, 1), HasSubstr(R"("a": "a\"b\\c\n")"));
}

TEST_F(Report, SizesMustBeTheSame) {
  const CompareOptions options{flat("a.png", 64, 48, 1), flat("b.png", 48, 64, 1), ""};
  try {
    compare(options);
    ADD_FAILURE();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("a.png is 64 x 48"));
    EXPECT_THAT(error.what(), HasSubstr("b.png is 48 x 64"));
  }
}

TEST_F(Report, FileThatCannotBeWritten) {
  const std::string a = flat("a.png", 20, 20, 1);
  testing::internal::CaptureStdout();
  EXPECT_THROW(compare({a, a, path("no/such/folder.json")}), std::runtime_error);
  testing::internal::GetCapturedStdout();
}

}  // namespace
}  // namespace sonard::client
