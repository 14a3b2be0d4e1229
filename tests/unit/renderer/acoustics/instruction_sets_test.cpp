// SPDX-License-Identifier: Apache-2.0
// Images do not depend on the machine: the versions of the receiver's loops for different instruction sets
// give the same bits (renderer/simd.hpp).
#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/acoustics/point_spread.hpp"
#include "renderer/acoustics/receiver.hpp"
#include "tests/unit/renderer/acoustics/several_pings.hpp"

std::vector<std::uint16_t> pings_for_baseline();
#ifdef __x86_64__
std::vector<std::uint16_t> pings_for_avx2();
std::vector<std::uint16_t> pings_for_avx512();
#endif

namespace sonard::render {
namespace {

TEST(InstructionSets, TheOnePickedAtLoadTimeGivesTheBitsOfTheBaseline) {
  const std::vector<std::uint16_t> baseline = pings_for_baseline();
  EXPECT_GT(std::set<std::uint16_t>(baseline.begin(), baseline.end()).size(),
            10000);  // the pings are not empty
  EXPECT_EQ(baseline, (several_pings<Receiver, PointSpread, PingRequest, EchoImage, WorkerPool>()));
}

#ifdef __x86_64__
TEST(InstructionSets, Avx2GivesTheBitsOfTheBaseline) {
  if (!__builtin_cpu_supports("avx2")) {
    GTEST_SKIP() << "this machine has no AVX2";
  }
  EXPECT_EQ(pings_for_baseline(), pings_for_avx2());
}

// AVX-512 implies FMA. If the loops used it, sums would be rounded once instead of twice.
TEST(InstructionSets, Avx512GivesTheBitsOfTheBaseline) {
  if (!__builtin_cpu_supports("avx512f")) {
    GTEST_SKIP() << "this machine has no AVX-512";
  }
  EXPECT_EQ(pings_for_baseline(), pings_for_avx512());
}
#endif

}  // namespace
}  // namespace sonard::render
