// SPDX-License-Identifier: Apache-2.0
// The scan for the options of `sonarview ping360`.
#include "clients/sonarview/ping360/options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace sonard::client {
namespace {

using testing::HasSubstr;

Ping360Options options(std::vector<const char*> words) {
  CLI::App app;
  const Ping360Arguments arguments(app);
  words.insert(words.begin(), {"ping360", "--udp", "127.0.0.1:12345"});
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

// protocol/ping360/README.md 2.3: clients cover 20 m with 1200 samples of 888 ticks and a pulse of 107 us.
TEST(Ping360Options, ARangeBecomesTheSamplesThatClientsChoose) {
  const Ping360Options scan = options({"--range", "20"});
  EXPECT_EQ(scan.line.text(), "udp 127.0.0.1:12345");
  EXPECT_EQ(scan.scan.number_of_samples, 1200);
  EXPECT_EQ(scan.scan.sample_period, 888);
  EXPECT_EQ(scan.scan.transmit_duration_us, 107);
  EXPECT_EQ(scan.scan.start_angle, 0);
  EXPECT_EQ(scan.scan.stop_angle, 399);
  EXPECT_FALSE(scan.automatic);
  EXPECT_TRUE(scan.all_round);
}

TEST(Ping360Options, AShortRangeHasFewerSamples) {
  const Ping360Options scan = options({"--range", "1"});
  EXPECT_EQ(scan.scan.number_of_samples, 666);
  EXPECT_EQ(scan.scan.sample_period, 80);
  EXPECT_EQ(options({"--range", "0.72"}).scan.sample_period, 80)
      << "480 samples of 80 units, in whole numbers";
}

TEST(Ping360Options, ASectorIsInDegreesFromAhead) {
  const Ping360Options scan = options({"--sector", "-45", "45", "--ahead", "200", "--step", "2"});
  EXPECT_EQ(scan.scan.start_angle, 150);
  EXPECT_EQ(scan.scan.stop_angle, 250);
  EXPECT_EQ(scan.scan.num_steps, 2);
  EXPECT_TRUE(scan.automatic) << "only the head goes to and fro";
  EXPECT_FALSE(scan.all_round);
}

TEST(Ping360Options, WhatNoHeadCanDoIsRefused) {
  EXPECT_THAT(complaint({"--range", "1", "--samples", "1200"}), HasSubstr("too fine"));
  EXPECT_THAT(complaint({"--samples", "1201"}), HasSubstr("--samples"));
  EXPECT_THAT(complaint({"--sector", "0", "360"}), HasSubstr("are equal"));
  EXPECT_THAT(complaint({"--tty", "/dev/ttyUSB0"}), HasSubstr("excludes"));
}

}  // namespace
}  // namespace sonard::client
