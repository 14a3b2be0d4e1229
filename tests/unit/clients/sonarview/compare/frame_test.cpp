// SPDX-License-Identifier: Apache-2.0
// Files that can be compared, written byte by byte in their formats, and files that are refused.
#include "clients/sonarview/compare/frame.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>

namespace sonard::client {
namespace {

using testing::HasSubstr;

class Frame : public testing::Test {
 protected:
  Frame() { std::filesystem::create_directories(folder_); }
  ~Frame() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return path(name);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

 private:
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) /
                                  testing::UnitTest::GetInstance()->current_test_info()->name();
};

/// A file in NumPy's format 1.0, padded so that the samples begin at a multiple of 64.
std::string npy(const std::string& descr, const std::string& shape, const std::string& samples) {
  std::string header = "{'descr': '" + descr + "', 'fortran_order': False, 'shape': " + shape + ", }";
  header.resize(117, ' ');
  return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + "\n" + samples;
}

void expect_refused(const std::string& source, const std::string& message) {
  try {
    load_frame(source);
    ADD_FAILURE() << source << " was taken";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr(message));
    EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
  }
}

TEST_F(Frame, PicturesAreGrey) {
  cv::Mat picture(2, 3, CV_8UC3, cv::Scalar(40, 40, 40));
  picture.at<cv::Vec3b>(1, 2) = {255, 255, 255};
  cv::imwrite(path("picture.png"), picture);
  const cv::Mat frame = load_frame(path("picture.png"));
  ASSERT_EQ(frame.size(), cv::Size(3, 2));
  EXPECT_EQ(frame.at<double>(0, 0), 40);
  EXPECT_EQ(frame.at<double>(1, 2), 255);
}

TEST_F(Frame, DumpedPingHasRangeUpwards) {
  // Two lines of three beams, the near line first.
  const cv::Mat frame = load_frame(write("ping.npy", npy("|u1", "(2, 3)", "\x01\x02\x03\x04\x05\x06")));
  ASSERT_EQ(frame.size(), cv::Size(3, 2));
  EXPECT_EQ(frame.at<double>(0, 0), 4);
  EXPECT_EQ(frame.at<double>(1, 2), 3);
}

TEST_F(Frame, SixteenBitsHaveTheSameScale) {
  const cv::Mat frame =
      load_frame(write("ping.npy", npy("<u2", "(1, 2)", std::string("\xff\xff\x01\x01", 4))));
  EXPECT_DOUBLE_EQ(frame.at<double>(0, 0), 255);
  EXPECT_DOUBLE_EQ(frame.at<double>(0, 1), 1);  // 257 of 65535 in 8 bits
}

TEST_F(Frame, PingOfADump) {
  const std::string index = write("gemini.csv",
                                  "number,id,transmit_us,lines,beams,crc32\n"
                                  "7,7,1000,1,2,00000000\n12,12,2000,1,2,00000000\n");
  write("gemini-00000012.npy", npy("|u1", "(1, 2)", "ab"));
  EXPECT_EQ(load_frame(index + "#12").at<double>(0, 1), 'b');
  expect_refused(index + "#1", "has no ping 1");
  expect_refused(index + "#7", "gemini-00000007.npy: no such file");
  expect_refused(index + "#seven", "expected");
  expect_refused(index, "#PING");
}

TEST_F(Frame, TurnOfAScan) {
  // Steps of 90 degrees, 8 bits, all round. Bearing 3200 is ahead, in the middle of the picture, which begins
  // astern.
  const auto line = [](int turn, int bearing, const char* bins) {
    return R"({"number":0,"turn":)" + std::to_string(turn) + R"(,"unix_s":1.5,"bearing":)" +
           std::to_string(bearing) +
           R"(,"left_limit":0,"right_limit":0,"step":1600,"all_round":true,"bits":8,"bins":")" + bins +
           "\"}\n";
  };
  const std::string steps = line(0, 3200, "1020");
  std::string text = steps + line(1, 3200, "01ff") + line(1, 4800, "0304") + line(1, 0, "0506");
  for (std::size_t at = text.find("1600"); at != std::string::npos; at = text.find("1600", at)) {
    text.replace(at, 4, "160");  // the step is one byte: 9 degrees, 40 columns
  }
  const std::string file = write("turn.jsonl", text);
  const cv::Mat frame = load_frame(file + "#1");
  ASSERT_EQ(frame.size(), cv::Size(40, 2));
  EXPECT_EQ(frame.at<double>(0, 20), 255);  // the far bin, ahead
  EXPECT_EQ(frame.at<double>(1, 30), 3);    // the near bin, to starboard
  EXPECT_EQ(frame.at<double>(0, 0), 6);     // astern
  EXPECT_EQ(frame.at<double>(0, 10), 0);    // there is no line to port
  expect_refused(file + "#2", "has no turn 2");
  expect_refused(file, "#TURN");
  expect_refused(write("other.jsonl", line(0, 3200, "10") + "[3\n") + "#0",
                 "other.jsonl:1: step 1600 is out of range");
}

TEST_F(Frame, OtherFilesAreRefused) {
  expect_refused(path("missing.png"), "missing.png: no such file");
  expect_refused(testing::TempDir(), "is a folder");
  expect_refused(write("text.png", "no picture"), "text.png: is not a PNG or JPEG picture");
  expect_refused(write("empty.png", ""), "is not a PNG or JPEG picture");
  expect_refused(write("text.npy", "no array"), "is not a NumPy file");
  expect_refused(write("floats.npy", npy("<f4", "(1, 1)", "abcd")),
                 "is not a table of 8-bit or 16-bit samples");
  expect_refused(write("flat.npy", npy("|u1", "(4,)", "abcd")), "is not a table");
  expect_refused(write("short.npy", npy("|u1", "(2, 3)", "abcde")), "does not have the number of samples");
  expect_refused(write("long.npy", npy("|u1", "(2, 2)", "abcde")), "does not have the number of samples");
  expect_refused(write("none.npy", npy("|u1", "(0, 3)", "")), "has no samples");
  expect_refused(write("huge.npy", npy("|u1", "(999999, 999999)", "")),
                 "does not have the number of samples");
  expect_refused(write("longer.npy", npy("|u1", "(9999999999, 1)", "")), "too many samples");
  expect_refused(write("text.jsonl", "no line\n") + "#0", "text.jsonl:1:");
}

// Two lines of three beams, laid out by docs/logs.md 1.3 and 1.4, with raw pixels and zeros in unused fields.
std::string dat_of(const std::string& pixels) {
  const auto bytes = [](std::uint64_t value, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) {
      text.push_back(static_cast<char>(value >> (8 * i)));
    }
    return text;
  };
  const auto f64 = [&](double value) { return bytes(std::bit_cast<std::uint64_t>(value), 8); };
  const auto f32 = [&](float value) { return bytes(std::bit_cast<std::uint32_t>(value), 4); };
  const std::string body = bytes(1, 2) + bytes(0xEFEF, 2) + bytes(3, 2) + bytes(0, 4) + bytes(2, 4) +
                           bytes(0, 2) + bytes(0, 4) + bytes(3, 4) + bytes(1, 2) + bytes(6, 4) + pixels +
                           f64(1.0) + f64(0.0) + f64(-1.0) + bytes(0, 4) + bytes(18'750, 4) + f32(120.0F) +
                           f64(1.5) + bytes(0, 2) + f32(1500.0F) + bytes(50, 2) + bytes(0, 4) +
                           bytes(0xDEDE, 2);
  return "*" + bytes(2, 1) + bytes(21 + body.size(), 4) + f64(1.5) + bytes(0, 1) + bytes(1194, 2) +
         bytes(100, 2) + bytes(0, 2) + body;
}

TEST_F(Frame, ImagesOfALogAreCounted) {
  const std::string log = write("log.dat", dat_of("abcdef") + dat_of("uvwxyz") + "\xDE\xDE");
  const cv::Mat frame = load_frame(log + "#1");
  ASSERT_EQ(frame.size(), cv::Size(3, 2));
  EXPECT_EQ(frame.at<double>(1, 0), 'u');  // the near line is at the bottom
  EXPECT_EQ(frame.at<double>(0, 2), 'z');
  expect_refused(log + "#2", "has no image 2; it has 2 images");
  expect_refused(log + "#", "expected");
  expect_refused(write("other.glf", "PK, or not") + "#0", "is not a log");
}

}  // namespace
}  // namespace sonard::client
