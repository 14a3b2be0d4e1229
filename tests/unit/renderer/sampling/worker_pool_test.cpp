// SPDX-License-Identifier: Apache-2.0
#include "renderer/worker_pool.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <new>
#include <numeric>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace sonard::render {
namespace {

using namespace std::chrono_literals;

TEST(WorkerPool, RunsEveryJobOnce) {
  for (const unsigned threads : {1U, 2U, 7U}) {
    WorkerPool pool(threads);
    EXPECT_EQ(pool.size(), threads);
    for (int repeat = 0; repeat < 300; ++repeat) {
      std::vector<int> runs(static_cast<std::size_t>(repeat), 0);
      pool.run(repeat, [&](int i) { ++runs[static_cast<std::size_t>(i)]; });
      EXPECT_EQ(std::accumulate(runs.begin(), runs.end(), 0), repeat);
      EXPECT_TRUE(std::all_of(runs.begin(), runs.end(), [](int n) { return n == 1; }));
    }
  }
}

// Pauses from nothing to well beyond the spin: workers are caught running, spinning, falling asleep and
// asleep.
TEST(WorkerPool, WakesFromAnyState) {
  for (const unsigned threads : {2U, 5U}) {
    WorkerPool pool(threads);
    std::vector<int> sum(64, 0);
    for (int repeat = 0; repeat < 400; ++repeat) {
      std::this_thread::sleep_for(std::chrono::microseconds(repeat % 8 * 20));
      pool.run(64, [&](int i) { sum[static_cast<std::size_t>(i)] += repeat; });
    }
    EXPECT_TRUE(std::all_of(sum.begin(), sum.end(), [](int n) { return n == 400 * 399 / 2; }));
  }
}

// All threads of a run see the writes of the run before.
TEST(WorkerPool, RunsSeeWhatEarlierOnesWrote) {
  WorkerPool pool(4);
  std::vector<int> values(257, 0);
  for (int repeat = 0; repeat < 200; ++repeat) {
    std::vector<int> next(values.size());
    pool.run(static_cast<int>(values.size()), [&](int i) {
      const auto k = static_cast<std::size_t>(i);
      next[k] = values[(k + 100) % values.size()] + 1;
    });
    values.swap(next);
  }
  EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](int n) { return n == 200; }));
}

TEST(WorkerPool, LongJobsAreWaitedFor) {
  WorkerPool pool(3);
  std::vector<int> done(3, 0);
  pool.run(3, [&](int i) {
    std::this_thread::sleep_for(5ms * i);
    done[static_cast<std::size_t>(i)] = 1;
  });
  EXPECT_EQ(done, std::vector<int>({1, 1, 1}));
}

// Memory may run out in any job, on the caller's thread or on a worker's.
TEST(WorkerPool, HandsOnWhatAJobThrowsWhenAllAreDone) {
  for (const unsigned threads : {1U, 2U, 7U}) {
    WorkerPool pool(threads);
    for (int repeat = 0; repeat < 100; ++repeat) {
      std::atomic<int> done = 0;
      EXPECT_THROW(pool.run(64,
                            [&](int i) {
                              if (i % 3 == 0) {
                                throw std::bad_alloc();
                              }
                              ++done;
                            }),
                   std::bad_alloc);
      const int before = done;
      EXPECT_TRUE(threads == 1 || before == 42);
      pool.run(64, [&](int) { ++done; });
      EXPECT_EQ(done, before + 64) << "it goes on as if nothing had been";
    }
  }
}

TEST(WorkerPool, EndsRightAfterWork) {
  for (int repeat = 0; repeat < 200; ++repeat) {
    WorkerPool pool(4);
    std::atomic<int> runs{0};
    pool.run(repeat % 3, [&](int) { ++runs; });
    EXPECT_EQ(runs, repeat % 3);
  }
}

// Spinning is bounded: an idle pool uses no processor time. A worker that kept spinning would use 200 ms.
TEST(WorkerPool, SleepsWhenIdle) {
  WorkerPool pool(2);
  pool.run(2, [](int) {});
  std::this_thread::sleep_for(10ms);
  const std::clock_t before = std::clock();
  std::this_thread::sleep_for(200ms);
  EXPECT_LT(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC, 0.02);
}

}  // namespace
}  // namespace sonard::render
