// SPDX-License-Identifier: Apache-2.0
#include "server/recording/log_names.hpp"

#include <gtest/gtest.h>

#include "tests/unit/server/recording/fixture.hpp"

namespace sonard::server {
namespace {

constexpr double time_s = 1'479'651'753.25;  // 2026-11-20 14:22:33.25

TEST(LogNames, AreMadeOfTheTime) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(free_stem(folder.path(), time_s), "2026-11-20-142233");
  EXPECT_EQ(mcap_path("a", "s").string(), "a/log_s.mcap");
  EXPECT_EQ(pcapng_path("a", "s").string(), "a/log_s.pcapng");
  EXPECT_EQ(sonar_path("a", "s").string(), "a/log_s.sonar");
  EXPECT_EQ(glf_path("a", "s").string(), "a/log_s.glf");
  EXPECT_EQ(dat_path("a", "s").string(), "a/data_s.dat");
  EXPECT_EQ(unfinished_glf_path("a", "s").string(), "a/log_s.glf.part");
}

TEST(LogNames, OfHeadsHoldNothingThatAFileNameMayNot) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(free_stem(folder.path(), time_s, "../a b/\n-1.2"), "2026-11-20-142233_.._a_b__-1.2");
}

TEST(LogNames, AreFreeWhateverStandsInTheWay) {
  for (const char* taken :
       {"log_2026-11-20-142233.mcap", "log_2026-11-20-142233.pcapng", "log_2026-11-20-142233.glf",
        "log_2026-11-20-142233.sonar", "data_2026-11-20-142233.dat", "log_2026-11-20-142233.glf.part"}) {
    const test::TemporaryFolder folder;
    test::write_file(folder.path() / taken, {1});
    EXPECT_EQ(free_stem(folder.path(), time_s), "2026-11-20-142233-2") << taken;
    test::write_file(folder.path() / "log_2026-11-20-142233-2.mcap", {1});
    EXPECT_EQ(free_stem(folder.path(), time_s), "2026-11-20-142233-3") << taken;
  }
}

TEST(LogNames, TellADatOfOurs) {
  EXPECT_EQ(stem_of_dat("/a/data_2026-11-20-142233_bow.dat"), "2026-11-20-142233_bow");
  EXPECT_EQ(stem_of_dat("/a/other.dat"), "");
  EXPECT_EQ(stem_of_dat("/a/data_2026-11-20-142233_bow.dat.damaged"), "");
}

}  // namespace
}  // namespace sonard::server
