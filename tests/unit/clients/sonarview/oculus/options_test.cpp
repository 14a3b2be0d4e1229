// SPDX-License-Identifier: Apache-2.0
// The fire command for the options of `sonarview oculus`.
#include "clients/sonarview/oculus/options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <string>
#include <vector>

namespace sonard::client {
namespace {

using testing::HasSubstr;

OculusOptions options(std::vector<const char*> words) {
  CLI::App app;
  const OculusArguments arguments(app);
  words.insert(words.begin(), "oculus");
  app.parse(static_cast<int>(words.size()), words.data());
  return arguments.options();
}

std::string complaint(const std::vector<const char*>& words) {
  try {
    options(words);
    return "";
  } catch (const CLI::Error& error) {
    return error.what();
  }
}

TEST(OculusOptions, WithoutAnyItFiresFor512BeamsAtTheLowFrequency) {
  const OculusOptions usual = options({});
  EXPECT_EQ(usual.head, "");
  EXPECT_EQ(usual.port, 52100);
  EXPECT_EQ(usual.status_port, 52102);
  EXPECT_EQ(usual.fire.version, 2);
  ASSERT_TRUE(usual.fire.extension);
  EXPECT_EQ(usual.fire.extension->flags, 0U);
  const oculus::Fire& fire = usual.fire.fire;
  EXPECT_EQ(fire.master_mode, 1);
  EXPECT_EQ(fire.ping_rate, 0);
  EXPECT_EQ(fire.flags, 0x49);
  EXPECT_EQ(fire.gamma, 127);
  EXPECT_EQ(fire.range, 20.0);
  EXPECT_EQ(fire.sound_speed_mps, 1500.0);
}

// protocol/oculus/README.md 3.2 and 3.3.
TEST(OculusOptions, WordsBecomeFlagsAndCodes) {
  const OculusOptions wide = options(
      {"--frequency", "high",          "--beams", "256",    "--bits",  "32",      "--row-gains", "--rate",
       "40",          "--range",       "5",       "--gain", "70",      "--gamma", "255",         "--salinity",
       "35",          "--sound-speed", "0",       "--head", "10.0.0.4"});
  const oculus::Fire& fire = wide.fire.fire;
  EXPECT_EQ(fire.master_mode, 2);
  EXPECT_EQ(fire.ping_rate, 2);
  EXPECT_EQ(fire.flags, 0x0F);
  EXPECT_EQ(wide.fire.extension->flags, 0x200U);
  EXPECT_EQ(fire.gamma, 255);
  EXPECT_EQ(fire.gain_percent, 70.0);
  EXPECT_EQ(fire.salinity_ppt, 35.0);
  EXPECT_EQ(fire.sound_speed_mps, 0.0);
  EXPECT_EQ(wide.head, "10.0.0.4");
  EXPECT_EQ(options({"--bits", "16"}).fire.fire.flags, 0x4B);
  EXPECT_EQ(options({"--bits", "16"}).fire.extension->flags, 0U);
  for (const auto& [hz, code] : {std::pair{"10", 0}, {"15", 1}, {"40", 2}, {"5", 3}, {"2", 4}}) {
    EXPECT_EQ(options({"--rate", hz}).fire.fire.ping_rate, code);
  }
  EXPECT_EQ(options({"--seconds", "1.5"}).run.duration, std::chrono::milliseconds{1500});
}

TEST(OculusOptions, RefusesWhatNoFireCanSay) {
  EXPECT_THAT(complaint({"--rate", "20"}), HasSubstr("--rate"));
  EXPECT_THAT(complaint({"--beams", "128"}), HasSubstr("--beams"));
  EXPECT_THAT(complaint({"--bits", "24"}), HasSubstr("--bits"));
  EXPECT_THAT(complaint({"--gamma", "0"}), HasSubstr("--gamma"));
  EXPECT_THAT(complaint({"--bind", "here"}), HasSubstr("expected an IPv4 address, found 'here'"));
}

}  // namespace
}  // namespace sonard::client
