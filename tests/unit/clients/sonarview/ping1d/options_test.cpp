// SPDX-License-Identifier: Apache-2.0
// The settings for the options of `sonarview ping1d`.
#include "clients/sonarview/ping1d/options.hpp"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <vector>

namespace sonard::client {
namespace {

using namespace ping1d;

Ping1dOptions options(std::vector<const char*> words) {
  CLI::App app;
  const Ping1dArguments arguments(app);
  words.insert(words.begin(), {"ping1d", "--udp", "127.0.0.1:9090"});
  app.parse(static_cast<int>(words.size()), words.data());
  return arguments.options();
}

TEST(Ping1dOptions, TheHeadChoosesRangeAndGainByDefault) {
  const std::vector<Command> expected{SetPingEnable{1}, SetPingInterval{100}, SetSpeedOfSound{1'500'000},
                                      SetModeAuto{1}};
  EXPECT_TRUE(options({}).settings == expected);
  EXPECT_EQ(options({}).line.text(), "udp 127.0.0.1:9090");
}

TEST(Ping1dOptions, ARangeIsManualMode) {
  const std::vector<Command> expected{SetPingEnable{1}, SetPingInterval{50},   SetSpeedOfSound{1'480'500},
                                      SetModeAuto{0},   SetRange{500, 20'000}, SetGainSetting{3}};
  EXPECT_TRUE(options({"--range", "20", "--start", "0.5", "--gain", "3", "--interval", "50", "--sound-speed",
                       "1480.5"})
                  .settings == expected);
}

TEST(Ping1dOptions, GainAndStartNeedARange) {
  EXPECT_THROW(options({"--gain", "3"}), CLI::ValidationError);
  EXPECT_THROW(options({"--start", "3"}), CLI::ValidationError);
  EXPECT_THROW(options({"--range", "0.5"}), CLI::ValidationError);
}

}  // namespace
}  // namespace sonard::client
