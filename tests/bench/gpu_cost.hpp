// SPDX-License-Identifier: Apache-2.0
// Predicts the time of a ping on engine `gpu` from the counts of its work and the published rates of a card.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "renderer/ping.hpp"
#include "tests/bench/measurements.hpp"

namespace sonard::bench {

/// The counts of a ping's work by their names in the results.
std::vector<std::pair<std::string, double>> counts_of(const render::PingStatistics& ping);

/// Milliseconds by shader file, and `rest_stage`: everything else.
using StageTimes = std::map<std::string, double>;
inline constexpr const char* rest_stage = "rest";
double total_ms(const StageTimes& times);
/// The shader files in the order of a ping, then `rest_stage`.
std::vector<std::string> gpu_stages();

/// A card by its published rates.
struct GpuCard {
  std::string name;
  double lanes, clock_ghz;  ///< 32-bit instructions per second: lanes x clock
  double memory_gb_per_s, bus_gb_per_s;
  double additions_per_clock;  ///< assumed: 32-bit atomics on different words of memory
  double dispatch_us;          ///< with its barrier
  std::string source;          ///< of the published rates
};

const std::vector<GpuCard>& gpu_cards();

/// Shares of a card's instructions that compute shaders with long loops and few warps attain. The prediction
/// with each is a bound.
inline constexpr double least_attained = 0.08, most_attained = 0.20;

/// Predicts all stages; they add up, because each depends on the one before.
StageTimes predict(const render::PingStatistics& ping, const GpuCard& card, double attained);

}  // namespace sonard::bench
