// SPDX-License-Identifier: Apache-2.0
// `sonarview micron` as a process, against a head on real lines. The echoes are a formula of bearing and bin,
// so every sample of every file that it writes has a known value.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/run_process.hpp"
#include "tests/system/sonarview/fake_head.hpp"

namespace sonard::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

constexpr int bins = 40;

/// Changes with each bin and each step of 32 units.
std::uint8_t echo(int bearing, int bin) {
  return static_cast<std::uint8_t>(bearing / 32 + 3 * bin);
}

/// Parts of 1 to 60 bytes, and sometimes additional bytes, many of which look like frames.
std::function<std::vector<FakeHead::Bytes>(const FakeHead::Bytes&)> poor_line() {
  return [random = std::mt19937(7)](const FakeHead::Bytes& frame) mutable {
    std::vector<FakeHead::Bytes> pieces;
    if (random() % 4 == 0) {
      FakeHead::Bytes noise(1 + random() % 11);
      std::ranges::generate(noise, [&] { return random() % 3 == 0 ? std::uint8_t{'@'} : random() % 256; });
      pieces.push_back(noise);
    }
    for (std::size_t at = 0; at < frame.size();) {
      const std::size_t size = std::min<std::size_t>(1 + random() % 60, frame.size() - at);
      const auto begin = frame.begin() + static_cast<std::ptrdiff_t>(at);
      pieces.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(size));
      at += size;
    }
    return pieces;
  };
}

/// The values of the last line of standard output that begins with `word`.
std::map<std::string, std::string> values_of(const std::string& out, const std::string& word) {
  std::map<std::string, std::string> values;
  std::istringstream in(out);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(word + " ", 0) != 0) {
      continue;
    }
    std::istringstream words(line);
    for (std::string pair; words >> pair;) {
      const std::size_t equals = pair.find('=');
      if (equals != std::string::npos) {
        values[pair.substr(0, equals)] = pair.substr(equals + 1);
      }
    }
  }
  return values;
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::vector<std::string> lines;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    lines.push_back(line);
  }
  return lines;
}

class SonarviewMicron : public testing::Test {
 protected:
  SonarviewMicron()
      : folder_(fs::temp_directory_path() / ("sonarview_micron_" + std::to_string(getpid()) + "_" +
                                             testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::create_directories(folder_);
  }
  ~SonarviewMicron() override { fs::remove_all(folder_); }

  static server::SerialLinkConfig by_tcp() { return {{{any_port(), loopback()}}, {}, {}, 0}; }
  static server::SerialLinkConfig by_udp() { return {{}, {{any_port(), loopback()}}, {}, 0}; }
  static server::SerialLinkConfig by_pty(const fs::path& link = {}) { return {{}, {}, {{link}}, 0}; }
  static Endpoint any_port() { return {0x7F000001, 0}; }
  static server::AllowList loopback() { return {{0x7F000000, 8}}; }

  static ProcessResult run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {SONARVIEW_PROGRAM, "micron"});
    const ProcessResult result = run_process(arguments, 40s);
    EXPECT_FALSE(result.timed_out) << result.out << result.err;
    return result;
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Checks every sample of a picture whose column k is the line at `from + k * step`.
  static void expect_polar(const std::string& file, int columns, int from, int step) {
    const cv::Mat polar = cv::imread(file, cv::IMREAD_UNCHANGED);
    ASSERT_EQ(polar.type(), CV_8UC1) << file;
    ASSERT_EQ(polar.size(), cv::Size(columns, bins));
    int wrong = 0;
    for (int column = 0; column < columns; ++column) {
      for (int bin = 0; bin < bins; ++bin) {
        wrong += polar.at<uchar>(bins - 1 - bin, column) != echo((from + column * step) % 6400, bin) ? 1 : 0;
      }
    }
    EXPECT_EQ(wrong, 0);
  }

  const fs::path folder_;
  const std::vector<std::string> forty_bins_{"--bins", "40", "--range", "10"};
};

std::vector<std::string> operator+(std::vector<std::string> left, const std::vector<std::string>& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

TEST_F(SonarviewMicron, AFullTurnByTcpHasEverySampleInItsPlace) {
  const FakeHead head(by_tcp(), {.echo = echo});
  const ProcessResult result =
      run(std::vector<std::string>{"--tcp", head.tcp(), "--turns", "1", "--out", path("out")} + forty_bins_);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto summary = values_of(result.out, "summary");
  EXPECT_EQ(summary.at("turns"), "1");
  EXPECT_EQ(summary.at("lines"), "200");
  EXPECT_EQ(summary.at("lines_missed"), "0");
  expect_polar(path("out/polar-last.png"), 200, 0, 32);
  EXPECT_TRUE(fs::exists(path("out/turn-last.png")));
}

TEST_F(SonarviewMicron, SaysWhatTheHeadCovers) {
  const FakeHead head(by_tcp(), {.echo = echo});
  const ProcessResult result =
      run({"--tcp", head.tcp(), "--lines", "2", "--range", "20", "--bins", "200", "--sound-speed", "1500"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  // 2 * 20 m / (1500 m/s * 200) = 133.3 us = 208.3 times 640 ns; 208 of them are 0.09984 m.
  const auto scan = values_of(result.out, "scan");
  EXPECT_EQ(scan.at("ad_interval"), "208");
  EXPECT_EQ(scan.at("range_m"), "19.968");
  EXPECT_THAT(result.err, HasSubstr("covers 19.968 m of 20 m"));
}

TEST_F(SonarviewMicron, APtyThatSplitsAndMakesNoiseLosesNothing) {
  const FakeHead head(by_pty(), {.echo = echo, .carry = poor_line()});
  const ProcessResult result =
      run(std::vector<std::string>{"--tty", head.tty(), "--turns", "2", "--step", "3.6", "--out", path("out"),
                                   "--every", "1", "--quiet"} +
          forty_bins_);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto summary = values_of(result.out, "summary");
  EXPECT_EQ(summary.at("lines"), "200");
  EXPECT_EQ(summary.at("lines_missed"), "0");
  EXPECT_GT(std::stoi(summary.at("bytes_dropped")), 20);
  EXPECT_EQ(summary.at("images_written"), "8");
  expect_polar(path("out/polar-000000.png"), 100, 0, 64);
  expect_polar(path("out/polar-000001.png"), 100, 0, 64);
  EXPECT_EQ(result.err, "");
}

TEST_F(SonarviewMicron, ATcpServerThatSplitsAndMakesNoiseLosesNothing) {
  const FakeHead head(by_tcp(), {.echo = echo, .carry = poor_line()});
  const ProcessResult result =
      run(std::vector<std::string>{"--tcp", head.tcp(), "--turns", "1", "--scan-left", "--step", "3.6",
                                   "--out", path("out")} +
          forty_bins_);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  expect_polar(path("out/polar-last.png"), 100, 0, 64);
}

TEST_F(SonarviewMicron, ASectorThroughAsternByUdp) {
  const FakeHead head(by_udp(), {.echo = echo});
  const ProcessResult result = run(std::vector<std::string>{"--udp", head.udp(), "--turns", "2", "--sector",
                                                            "162", "-162", "--out", path("out")} +
                                   forty_bins_);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  // 162 degrees to starboard is 3200 + 2880 units; 36 degrees further is 320. 640 units are 20 steps.
  EXPECT_EQ(values_of(result.out, "scan").at("lines_per_turn"), "21");
  EXPECT_EQ(values_of(result.out, "summary").at("turns"), "2");
  expect_polar(path("out/polar-last.png"), 21, 6080, 32);
  EXPECT_TRUE(fs::exists(path("out/fan-last.png")));
}

TEST_F(SonarviewMicron, FourBitLinesHoldTheWindow) {
  const FakeHead head(by_tcp(), {.echo = echo});
  const ProcessResult result =
      run(std::vector<std::string>{"--tcp", head.tcp(), "--lines", "3", "--four-bit", "--ad-low", "0",
                                   "--ad-span", "80", "--raw", path("lines.jsonl")} +
          forty_bins_);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto lines = lines_of(path("lines.jsonl"));
  ASSERT_EQ(lines.size(), 3U);
  // protocol/micron/README.md 6.3; a span of 80 dB is 255.
  std::string expected;
  for (int bin = 0; bin < bins; ++bin) {
    const int nibble = std::min(15, echo(3200, bin) * 16 / 255);
    expected += std::string("0") + "0123456789abcdef"[nibble];
  }
  EXPECT_THAT(lines[0], HasSubstr("\"bearing\":3200,"));
  EXPECT_THAT(lines[0], HasSubstr("\"bits\":4,\"bins\":\"" + expected + "\"}"));
}

TEST_F(SonarviewMicron, WritesLinesAsTheyCame) {
  const FakeHead head(by_tcp(), {.echo = echo});
  const ProcessResult result = run(std::vector<std::string>{"--tcp", head.tcp(), "--turns", "1", "--raw",
                                                            path("lines.jsonl"), "--log-lines"} +
                                   forty_bins_);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto lines = lines_of(path("lines.jsonl"));
  ASSERT_EQ(lines.size(), 200U);
  const std::regex form(
      R"re(\{"number":(\d+),"turn":0,"unix_s":\d+\.\d+,"bearing":(\d+),.*"step":32,"all_round":true,"bits":8,)re"
      R"re("bins":"([0-9a-f]+)"\})re");
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::smatch found;
    ASSERT_TRUE(std::regex_match(lines[i], found, form)) << lines[i];
    const int bearing = std::stoi(found[2]);
    EXPECT_EQ(found[1], std::to_string(i));
    EXPECT_EQ(bearing, (3200 + 32 * static_cast<int>(i)) % 6400);
    std::ostringstream expected;
    for (int bin = 0; bin < bins; ++bin) {
      expected << std::hex << (echo(bearing, bin) >> 4) << (echo(bearing, bin) & 15);
    }
    EXPECT_EQ(found[3], expected.str());
  }
  EXPECT_EQ(values_of(result.out, "line").at("number"), "199");
  EXPECT_EQ(values_of(result.out, "line").at("bearing_deg"), "-1.8");
}

TEST_F(SonarviewMicron, GoesOnWhereItWasWhenATcpServerComesBack) {
  const FakeHead head(by_tcp(), {.echo = echo, .vanish_at_ping = 60});
  const ProcessResult result =
      run(std::vector<std::string>{"--tcp", head.tcp(), "--turns", "2"} + forty_bins_);
  EXPECT_THAT(result.err, HasSubstr("lost tcp " + head.tcp()));
  EXPECT_THAT(result.err, HasSubstr("tcp " + head.tcp() + " is open again"));
  const auto summary = values_of(result.out, "summary");
  EXPECT_EQ(summary.at("reconnects"), "1");
  EXPECT_EQ(summary.at("turns"), "2");
  EXPECT_EQ(summary.at("head_commands"), "1") << "the head had kept its parameters";
  // Lines in transit when the serial line vanished are lost, and reported as missing.
  EXPECT_GE(std::stoi(summary.at("lines_missed")), 1);
  EXPECT_EQ(std::stoi(summary.at("lines")) + std::stoi(summary.at("lines_missed")), 400);
  EXPECT_EQ(result.exit_code, 4);
}

TEST_F(SonarviewMicron, OpensATtyAgainThatHadVanished) {
  const FakeHead head(by_pty(folder_ / "tty"), {.echo = echo, .vanish_at_ping = 60});
  const ProcessResult result =
      run(std::vector<std::string>{"--tty", head.tty(), "--turns", "1"} + forty_bins_);
  EXPECT_THAT(result.err, HasSubstr("lost tty " + head.tty()));
  EXPECT_EQ(values_of(result.out, "summary").at("reconnects"), "1");
  EXPECT_EQ(values_of(result.out, "summary").at("turns"), "1");
}

TEST_F(SonarviewMicron, GivesUpOnALineThatDoesNotComeBack) {
  const FakeHead head(by_tcp(), {.echo = echo, .vanish_at_ping = 20, .away = 1h});
  const ProcessResult result =
      run(std::vector<std::string>{"--tcp", head.tcp(), "--turns", "1", "--wait", "1.5"} + forty_bins_);
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("did not open again within 1.5 s: Connection refused"));
}

TEST_F(SonarviewMicron, ALineThatNobodyAnswersOnHasNoHead) {
  const FakeHead other(by_pty(), {.device =
                                      [] {
                                        micron::DeviceConfig device;
                                        device.node = 7;
                                        return device;
                                      }(),
                                  .echo = echo});
  const ProcessResult result = run({"--tty", other.tty(), "--node", "2", "--wait", "3"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(
      result.err,
      HasSubstr("is open, but head 2 sent nothing within 3.0 s: only node 7 sent frames (to view one, use "
                "--node 7)"));
  EXPECT_EQ(run({"--tty", other.tty(), "--node", "7", "--lines", "4"}).exit_code, 0);
}

TEST_F(SonarviewMicron, ALineThatIsNotThereHasNoHead) {
  const ProcessResult result = run({"--tty", path("nothing"), "--wait", "1"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("cannot open tty " + path("nothing")));
  EXPECT_THAT(result.err, HasSubstr("No such file or directory"));
}

TEST_F(SonarviewMicron, RebootsAHeadFirst) {
  FakeHead::Settings settings{.echo = echo};
  settings.device.least_centring_time = 2s;  // long enough for the message
  const FakeHead head(by_tcp(), settings);
  const ProcessResult result =
      run(std::vector<std::string>{"--tcp", head.tcp(), "--reboot", "--lines", "10"} + forty_bins_);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("centring"));
}

TEST_F(SonarviewMicron, AFileThatCannotBeWrittenIsSaidAtOnce) {
  const ProcessResult result = run({"--tcp", "127.0.0.1:1", "--raw", path("no/such/folder")});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("cannot write " + path("no/such/folder")));
}

}  // namespace
}  // namespace sonard::test
