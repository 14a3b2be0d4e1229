// SPDX-License-Identifier: Apache-2.0
// Command lines and their meaning, and command lines that are refused.
#include "clients/sonarview/command_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "clients/sonarview/gemini/options.hpp"
#include "clients/sonarview/gemini/sockets.hpp"
#include "clients/sonarview/micron/options.hpp"

namespace sonard::client {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

struct Parsed {
  std::optional<Run> command_line;
  ExitStatus status = ExitStatus::ok;
  std::string out;
  std::string err;
};

Parsed parse(std::vector<const char*> words) {
  words.insert(words.begin(), "sonarview");
  Parsed parsed;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  parsed.command_line = parse_command_line(static_cast<int>(words.size()), words.data(), parsed.status);
  parsed.out = testing::internal::GetCapturedStdout();
  parsed.err = testing::internal::GetCapturedStderr();
  return parsed;
}

/// The options that the arguments of a subcommand read from these words. The whole program must accept them
/// too.
template <class Arguments>
auto options_of(const char* subcommand, std::vector<const char*> words) {
  CLI::App app;
  const Arguments arguments(app);
  std::vector<const char*> all{"sonarview"};
  all.insert(all.end(), words.begin(), words.end());
  app.parse(static_cast<int>(all.size()), all.data());
  words.insert(words.begin(), subcommand);
  const Parsed parsed = parse(std::move(words));
  EXPECT_EQ(parsed.err, "");
  EXPECT_TRUE(parsed.command_line);
  return arguments.options();
}

MicronOptions micron(std::vector<const char*> words) {
  return options_of<MicronArguments>("micron", std::move(words));
}

void expect_refused(const std::vector<const char*>& words, const std::string& message) {
  const Parsed parsed = parse(words);
  EXPECT_FALSE(parsed.command_line);
  EXPECT_EQ(parsed.status, ExitStatus::usage);
  EXPECT_THAT(parsed.err, HasSubstr(message));
}

TEST(CommandLine, WithoutASubcommandItIsAGemini) {
  const std::vector<const char*> words{"--range", "20", "--compression", "1",
                                       "--pings", "7",  "--continuous",  "100"};
  EXPECT_TRUE(parse(words).command_line);
  const GeminiOptions options = options_of<GeminiArguments>("gemini", words);
  EXPECT_EQ(options.settings.range_m, 20.0);
  EXPECT_EQ(options.settings.compression_log2, 1);
  EXPECT_EQ(options.settings.interval, std::chrono::microseconds{100'000});
  EXPECT_EQ(options.run.pings, 7U);
  EXPECT_EQ(options.client_address, 0U);
  EXPECT_EQ(options.run.wait, 5s);
  EXPECT_EQ(options.run.radius_px, 900);
}

TEST(CommandLine, CommandsLeaveFromTheAddressThatRoutesToTheHead) {
  EXPECT_EQ(address_towards(0x7F000002), 0x7F000001U);
  EXPECT_EQ(address_towards(0x7F000001), 0x7F000001U);
  EXPECT_EQ(options_of<GeminiArguments>("gemini", {"--client-address", "127.0.0.3"}).client_address,
            0x7F000003U);
}

TEST(CommandLine, GeminiMistakesAreSaidAsEver) {
  expect_refused({"--sonar-id", "1"}, "--sonar-id: 1 is reserved for production");
  expect_refused({"--head", "ten"}, "--head: expected an IPv4 address, found 'ten'");
  expect_refused({"--tcp", "127.0.0.1:4001"}, "not expected");
}

TEST(CommandLine, HelpIsNoMistake) {
  for (const auto& words : {std::vector<const char*>{"--help"}, {"micron", "--help"}}) {
    const Parsed parsed = parse(words);
    EXPECT_FALSE(parsed.command_line);
    EXPECT_EQ(parsed.status, ExitStatus::ok);
    EXPECT_THAT(parsed.out, HasSubstr("Exit status: 0"));
  }
}

TEST(CommandLine, AMicronIsReachedInOneOfThreeWays) {
  const LineAddress tcp = micron({"--tcp", "sonar.local:4001"}).line;
  EXPECT_EQ(tcp.way, LineAddress::Way::tcp);
  EXPECT_EQ(tcp.place, "sonar.local");
  EXPECT_EQ(tcp.port, 4001);
  const LineAddress udp = micron({"--udp", "10.0.0.7:1"}).line;
  EXPECT_EQ(udp.way, LineAddress::Way::udp);
  EXPECT_EQ(udp.text(), "udp 10.0.0.7:1");
  const LineAddress tty = micron({"--tty", "/dev/ttyUSB0", "--baud", "57600"}).line;
  EXPECT_EQ(tty.text(), "tty /dev/ttyUSB0 at 57600 baud");
  EXPECT_EQ(micron({"--tty", "x"}).line.baud, 115'200U);

  expect_refused({"micron"}, "one of them is required, with the address of the head");
  expect_refused({"micron", "--tcp", "a:1", "--tty", "b"}, "excludes");
  expect_refused({"micron", "--tcp", "a:1", "--baud", "9600"}, "--baud requires --tty");
  for (const char* place : {"host", "host:", ":1", "host:0", "host:65536", "host:1x", "host:-1"}) {
    expect_refused({"micron", "--tcp", place}, "expected HOST:PORT, found '" + std::string(place) + "'");
  }
}

TEST(CommandLine, MicronSettingsBecomeThoseOfAScan) {
  const MicronOptions options =
      micron({"--tty",     "x",   "--range",       "20",   "--bins",      "200",        "--step",   "0.45",
              "--gain",    "40",  "--node",        "7",    "--scan-left", "--four-bit", "--ad-low", "13",
              "--ad-span", "25",  "--sound-speed", "1450", "--turns",     "3",          "--lines",  "9",
              "--seconds", "1.5", "--reboot"});
  EXPECT_EQ(options.scan.range_m, 20.0);
  EXPECT_EQ(options.scan.bins, 200);
  EXPECT_EQ(options.scan.step, 8);
  EXPECT_EQ(options.scan.gain_percent, 40.0);
  EXPECT_FALSE(options.scan.clockwise);
  EXPECT_FALSE(options.scan.eight_bit);
  EXPECT_EQ(options.scan.ad_low_db, 13.0);
  EXPECT_EQ(options.scan.ad_span_db, 25.0);
  EXPECT_EQ(options.scan.sound_speed_mps, 1450.0);
  EXPECT_FALSE(options.scan.sector);
  EXPECT_EQ(options.client.node, 7);
  EXPECT_TRUE(options.client.reboot_first);
  EXPECT_EQ(options.sweeps, 3U);
  EXPECT_EQ(options.run.pings, 9U);
  EXPECT_EQ(options.run.duration, 1500ms);
}

TEST(CommandLine, StepsAreWholeSixteenthsOfAGradian) {
  const std::vector<std::pair<const char*, int>> steps{{"0.05625", 1}, {"0.225", 4},  {"0.45", 8},
                                                       {"0.9", 16},    {"1.8", 32},   {"3.6", 64},
                                                       {"7.2", 128},   {"0.50625", 9}};
  for (const auto& [text, units] : steps) {
    EXPECT_EQ(micron({"--tty", "x", "--step", text}).scan.step, units) << text;
  }
  expect_refused({"micron", "--tty", "x", "--step", "1"}, "the nearest is 1.0125");
  expect_refused({"micron", "--tty", "x", "--step", "0"}, "the nearest is 0.05625");
  expect_refused({"micron", "--tty", "x", "--step", "90"}, "14.34375 at most");
}

TEST(CommandLine, SectorsAreDegreesFromAhead) {
  const auto sector = [](const char* from, const char* to) {
    return micron({"--tty", "x", "--sector", from, to}).scan.sector.value();
  };
  EXPECT_EQ(sector("-45", "45").left, 2400);
  EXPECT_EQ(sector("-45", "45").right, 4000);
  EXPECT_EQ(sector("135", "-135").left, 5600);  // across astern
  EXPECT_EQ(sector("135", "-135").right, 800);
  EXPECT_EQ(sector("135", "225").right, 800);  // equal to -135
  EXPECT_EQ(sector("-180", "0").left, 0);
  expect_refused({"micron", "--tty", "x", "--sector", "-180", "180"}, "omit --sector to scan all round");
  expect_refused({"micron", "--tty", "x", "--sector", "10"}, "--sector");
}

TEST(CommandLine, BinsThatNoHeadCanTellApartAreRefused) {
  expect_refused({"micron", "--tty", "x", "--range", "0.5", "--bins", "1500"}, "too fine for a head");
  expect_refused({"micron", "--tty", "x", "--range", "100", "--bins", "1"}, "too coarse for a head");
}

TEST(CommandLine, TheWindowBelongsToFourBitLines) {
  expect_refused({"micron", "--tty", "x", "--ad-low", "10"}, "--ad-low requires --four-bit");
}

TEST(CommandLine, OptionsBeforeTheSubcommandAreNotLostInSilence) {
  expect_refused({"--range", "20", "micron", "--tty", "x"}, "--range: is before 'micron'");
  expect_refused({"micron", "--tty", "x", "--pings", "3"}, "--pings");
}

}  // namespace
}  // namespace sonard::client
