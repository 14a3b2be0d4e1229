#include "renderer/worker_pool.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace sonard::render {
namespace {

TEST(WorkerPool, RunsEveryJobOnce) {
  for (const unsigned threads : {1U, 2U, 7U}) {
    WorkerPool pool(threads);
    for (int repeat = 0; repeat < 300; ++repeat) {
      std::vector<int> runs(static_cast<std::size_t>(repeat), 0);
      pool.run(repeat, [&](int i) { ++runs[static_cast<std::size_t>(i)]; });
      EXPECT_EQ(std::accumulate(runs.begin(), runs.end(), 0), repeat);
      EXPECT_TRUE(std::all_of(runs.begin(), runs.end(), [](int n) { return n == 1; }));
    }
  }
}

}  // namespace
}  // namespace sonard::render
