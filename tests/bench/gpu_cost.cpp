// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/gpu_cost.hpp"

#include <algorithm>

#include "tests/bench/timing.hpp"

namespace sonard::bench {

namespace {

constexpr double giga = 1e9;
constexpr double ms_per_us = 1e-3;

double number(std::uint64_t count) {
  return static_cast<double>(count);
}

double bins_of(const render::PingStatistics& ping) {
  return number(ping.gpu.bytes_read_back) / sizeof(float);
}

/// Work of a stage. Lane instructions include lanes that wait for others of their warp.
struct Stage {
  const char* shader;
  double (*lane_instructions)(const render::PingStatistics&);
  double tail_cycles = 0;  ///< of the last group in each round, when the card has nothing else to do
};

// Constants of see, and of pieces, patches and bin together, fit the lane instructions of swell100k,
// ripple100k and docking (0.7, 1.4 and 4.7 G). These come from a program that ran the sweep in 64 lanes on
// all slices, and from instructions of engine `cpu`. Times on llvmpipe divide the sum among the three stages.
// Tails are estimates from the longest groups. The other constants were counted by hand in the shaders.
const std::vector<Stage>& stages() {
  using Ping = render::PingStatistics;
  static const std::vector<Stage> all = {
      {"place.comp", [](const Ping& p) { return 400 * number(p.gpu.work.triangles); }},
      {"lists.comp", [](const Ping& p) { return 60 * number(p.gpu.work.entries); }},
      {"things.comp", [](const Ping& p) { return 300 * number(p.gpu.work.entries); }},
      {"see.comp",
       [](const Ping& p) {
         const double in_slice = number(p.gpu.work.segments) / std::max(1.0, number(p.gpu.work.slices));
         return (650 + 2.6 * in_slice) * number(p.gpu.work.segments);
       },
       70e3},
      {"refine.comp", [](const Ping& p) { return 21e3 * number(p.gpu.work.slices); }, 40e3},
      {"pieces.comp", [](const Ping& p) { return 800 * number(p.samples); }},
      {"patches.comp", [](const Ping& p) { return 150 * number(p.samples); }},
      {"bin.comp", [](const Ping& p) { return 550 * number(p.samples); }},
      {"sums.comp", [](const Ping& p) { return 80 * bins_of(p); }}};
  return all;
}

// Assumed for all cards.
constexpr double wait_us = 30, cpu_ms = 0.1;  // from the end of the image to the CPU; calls of OpenGL
constexpr double attained_of_bytes = 0.6, attained_of_additions = 0.5;
constexpr double bytes_per_bin = 60;  // of the sums: cleared once, read twice; and the image

}  // namespace

std::vector<std::pair<std::string, double>> counts_of(const render::PingStatistics& ping) {
  const render::GpuWork& work = ping.gpu.work;
  return {{"triangles", number(work.triangles)},   {"entries", number(work.entries)},
          {"slices", number(work.slices)},         {"rounds", number(work.rounds)},
          {"segments", number(work.segments)},     {"visible", number(work.visible)},
          {"samples", number(ping.samples)},       {"additions", number(work.additions)},
          {"dispatches", number(work.dispatches)}, {"synchronisations", number(ping.gpu.synchronisations)},
          {"passes", number(ping.gpu.passes)},     {"read_back", number(ping.gpu.bytes_read_back)}};
}

double total_ms(const StageTimes& times) {
  double sum = 0;
  for (const auto& [stage, ms] : times) {
    sum += ms;
  }
  return sum;
}

std::vector<std::string> gpu_stages() {
  std::vector<std::string> names;
  for (const Stage& stage : stages()) {
    names.emplace_back(stage.shader);
  }
  names.emplace_back(rest_stage);
  return names;
}

// 3.2 us for a dispatch with its barrier was measured on an H200; it is assumed for other cards of NVIDIA.
const std::vector<GpuCard>& gpu_cards() {
  static const std::vector<GpuCard> cards = {
      {"H200", 132 * 128, 1.98, 4800, 63, 80, 3.2,
       "NVIDIA's data sheet of the H200, white paper of the H100"},
      {"RTX 4090", 16384, 2.52, 1008, 31.5, 48, 3.2, "NVIDIA's white paper of the Ada architecture"},
      {"RTX 3060", 3584, 1.78, 360, 31.5, 24, 3.2, "NVIDIA's page of the RTX 3060, white paper of the GA102"},
      {"AGX Orin", 2048, 1.3, 204.8, 204.8, 16, 6, "NVIDIA's technical brief of the AGX Orin 64 GB"},
      {"Iris Xe", 768, 1.35, 68, 68, 8, 6, "Intel's page of the Core i7-1185G7 (96 units)"}};
  return cards;
}

StageTimes predict(const render::PingStatistics& ping, const GpuCard& card, double attained) {
  const double clock = card.clock_ghz * giga;
  StageTimes times;
  for (const Stage& stage : stages()) {
    times[stage.shader] = ms_per_s * (stage.lane_instructions(ping) / (attained * card.lanes * clock) +
                                      stage.tail_cycles * number(ping.gpu.work.rounds) / clock);
  }
  times["bin.comp"] =
      std::max(times["bin.comp"], ms_per_s * number(ping.gpu.work.additions) /
                                      (attained_of_additions * card.additions_per_clock * clock));
  times["sums.comp"] = std::max(times["sums.comp"], ms_per_s * bytes_per_bin * bins_of(ping) /
                                                        (attained_of_bytes * card.memory_gb_per_s * giga));
  times[rest_stage] =
      ms_per_us * (card.dispatch_us * number(ping.gpu.work.dispatches) +
                   wait_us * number(ping.gpu.synchronisations)) +
      ms_per_s * number(ping.gpu.bytes_read_back) / (attained_of_bytes * card.bus_gb_per_s * giga) +
      cpu_ms * number(ping.gpu.passes);
  return times;
}

}  // namespace sonard::bench
