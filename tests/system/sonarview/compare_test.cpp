// SPDX-License-Identifier: Apache-2.0
// `sonarview compare` as a process: its output, its errors and its exit codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "tests/support/run_process.hpp"

namespace sonard::test {
namespace {

using testing::HasSubstr;

class CompareProgram : public testing::Test {
 protected:
  CompareProgram() { std::filesystem::create_directories(folder_); }
  ~CompareProgram() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string flat(const std::string& name, int width, int height, int value) const {
    cv::imwrite(path(name), cv::Mat(height, width, CV_8UC1, cv::Scalar(value)));
    return path(name);
  }
  static ProcessResult compare(std::vector<std::string> words) {
    words.insert(words.begin(), {SONARVIEW_PROGRAM, "compare"});
    return run_process(words);
  }

 private:
  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("compare_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(CompareProgram, PrintsATableAndWritesJson) {
  const ProcessResult result =
      compare({flat("a.png", 300, 200, 10), flat("b.png", 300, 200, 30), "--json", path("out.json")});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  // A difference of 20 everywhere: MSE 400, PSNR 10 log10(65025 / 400) = 22.1102 dB.
  EXPECT_THAT(result.out, HasSubstr("MSE               400.0000        0.0062          0\n"));
  EXPECT_THAT(result.out, HasSubstr("PSNR               22.1102 dB     0.2233          1\n"));
  const nlohmann::json written = nlohmann::json::parse(std::ifstream(path("out.json")));
  EXPECT_EQ(written["width"], 300);
  EXPECT_EQ(written["height"], 200);
}

TEST_F(CompareProgram, WhatCannotBeComparedEndsWithOne) {
  const std::string a = flat("a.png", 30, 20, 10);
  std::ofstream(path("notes.txt")) << "no picture";
  for (const auto& [other, why] : std::vector<std::pair<std::string, std::string>>{
           {flat("b.png", 20, 30, 10), "b.png is 20 x 30"},
           {path("missing.png"), "missing.png: no such file"},
           {path("notes.txt"), "notes.txt: is not a PNG or JPEG picture"}}) {
    const ProcessResult result = compare({a, other});
    EXPECT_EQ(result.exit_code, 1) << other;
    EXPECT_EQ(result.out, "") << other;
    EXPECT_THAT(result.err, HasSubstr("sonarview: "));
    EXPECT_THAT(result.err, HasSubstr(why));
  }
}

TEST_F(CompareProgram, ACommandLineWithoutSenseEndsWithTwo) {
  EXPECT_EQ(compare({}).exit_code, 2);
  EXPECT_EQ(compare({"a.png"}).exit_code, 2);
  EXPECT_EQ(compare({"a.png", "b.png", "c.png"}).exit_code, 2);
  EXPECT_EQ(compare({"--help"}).exit_code, 0);
}

}  // namespace
}  // namespace sonard::test
