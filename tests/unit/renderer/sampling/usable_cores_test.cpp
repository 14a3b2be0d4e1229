// SPDX-License-Identifier: Apache-2.0
#include "renderer/usable_cores.hpp"

#include <sched.h>

#include <string_view>
#include <thread>

#include <gtest/gtest.h>

#include "renderer/worker_pool.hpp"

namespace sonard::render {
namespace {

TEST(UsableCores, AreThoseThatTheSchedulerAllows) {
  std::thread([] {  // a thread of its own, since the others keep all cores
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    ASSERT_EQ(sched_getaffinity(0, sizeof allowed, &allowed), 0);
    int first = 0;
    while (!CPU_ISSET(first, &allowed)) {
      ++first;
    }
    CPU_ZERO(&allowed);
    CPU_SET(first, &allowed);
    ASSERT_EQ(sched_setaffinity(0, sizeof allowed, &allowed), 0);
    EXPECT_EQ(usable_cores(), 1U);
    EXPECT_EQ(WorkerPool().size(), 1U);
  })
      .join();
}

// The format: Documentation/admin-guide/cgroup-v2.rst of Linux, cpu.max.
TEST(UsableCores, OfAContainerAreItsQuotaRoundedUp) {
  EXPECT_EQ(cores_of_quota("100000 100000\n"), 1U);
  EXPECT_EQ(cores_of_quota("150000 100000\n"), 2U);
  EXPECT_EQ(cores_of_quota("50000 100000\n"), 1U);
  EXPECT_EQ(cores_of_quota("6400000 100000\n"), 64U);
  for (const std::string_view none :
       {"max 100000\n", "", "x", "100000", "100000 ", "100000 0\n", "-1 100000\n"}) {
    EXPECT_EQ(cores_of_quota(none), 0U) << none;
  }
}

}  // namespace
}  // namespace sonard::render
