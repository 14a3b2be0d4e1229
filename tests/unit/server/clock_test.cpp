// SPDX-License-Identifier: Apache-2.0
#include "server/clock/clock.hpp"

#include <thread>

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

using std::chrono::milliseconds;

TEST(ProcessorTime, StandsStillWhileAThreadWaits) {
  const ProcessorTime before = processor_time();
  std::this_thread::sleep_for(milliseconds{200});
  EXPECT_LT(processor_time().thread - before.thread, milliseconds{100});
}

TEST(ProcessorTime, OfTheProcessHoldsThatOfOtherThreads) {
  const ProcessorTime before = processor_time();
  std::thread([] {
    const ProcessorTime began = processor_time();
    while (processor_time().thread - began.thread < milliseconds{50}) {
    }
  }).join();
  const ProcessorTime after = processor_time();
  EXPECT_GE(after.process - before.process, milliseconds{50});
  EXPECT_LT(after.thread - before.thread, milliseconds{50});
}

}  // namespace
}  // namespace sonard::server
