// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/isolated.hpp"

#include <csignal>
#include <iostream>

#include <gtest/gtest.h>

namespace sonard::render {
namespace {

TEST(Isolated, HandsBackBytesAndLog) {
  const std::string big(3'000'000, 'x');
  const IsolatedResult result = run_isolated(
      [&] {
        std::cerr << "remark\n";
        return big;
      },
      10);
  EXPECT_EQ(result.bytes, big);
  EXPECT_NE(result.log.find("remark"), std::string::npos);
}

TEST(Isolated, PassesOnAnException) {
  try {
    run_isolated([]() -> std::string { throw std::runtime_error("no such thing"); }, 10);
    FAIL();
  } catch (const IsolatedFailure& failure) {
    EXPECT_STREQ(failure.what(), "no such thing");
  }
}

TEST(Isolated, SurvivesACrash) {
  EXPECT_THROW(run_isolated(
                   []() -> std::string {
                     std::raise(SIGSEGV);
                     return {};
                   },
                   10),
               IsolatedFailure);
}

TEST(Isolated, SurvivesAnExit) {
  EXPECT_THROW(run_isolated([]() -> std::string { ::_exit(0); }, 10), IsolatedFailure);
}

TEST(Isolated, EndsAnEndlessLoop) {
  EXPECT_THROW(run_isolated(
                   []() -> std::string {
                     for (volatile int i = 0;;) {
                       i = i + 1;
                     }
                   },
                   1),
               IsolatedFailure);
}

TEST(Isolated, LeavesThisProcessAlone) {
  int value = 1;
  run_isolated(
      [&] {
        value = 2;
        return std::string("done");
      },
      10);
  EXPECT_EQ(value, 1);
}

}  // namespace
}  // namespace sonard::render
