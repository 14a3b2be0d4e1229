// SPDX-License-Identifier: Apache-2.0
// What a ping of engine `gpu` makes a card do, and how long that takes by the card's published rates.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/ping.hpp"
#include "tests/bench/measurements.hpp"

namespace sonard::bench {

/// The work of one ping. Whole numbers, but for the last.
struct GpuWork {
  double passes = 0, views = 0, draw_calls = 0, triangles = 0, pixels = 0, samples = 0;
  double atomic_additions = 0;
  double uploaded_kib = 0, read_back_kib = 0;
  double synchronisations = 0;
  double cpu_part_ms = 0;  ///< what the CPU takes whatever draws; measured
};

/// What of a ping of `total_s` is neither drawing nor binning, and what of these two the CPU does itself.
double cpu_part_s(double total_s, const render::PingStatistics& statistics);

GpuWork work_of(const render::PingStatistics& statistics, double cpu_part_ms);

/// Each count as a metric of its own; nothing of a ping without passes, which only engine `gpu` has.
void add_work(Measurements& results, const Subject& subject, const GpuWork& work);

/// What add_work() has added of a subject.
std::optional<GpuWork> find_work(const Measurements& results, const Subject& subject);

/// A table of all subjects that have any, for a terminal.
std::string format_work(const Measurements& results);

/// A card by its published rates.
struct GpuCard {
  std::string name;
  std::string renderer;                             ///< what the renderer string of its OpenGL holds
  double drawing_flop_per_s, computing_flop_per_s;  ///< of fragment and of compute shaders, 32 bits
  double pixels_per_s;                              ///< written, of 32 bits
  double triangles_per_s;
  double additions_per_s;  ///< 32-bit atomics on different words of memory
  double memory_bytes_per_s;
  double bus_bytes_per_s;  ///< one way between CPU and GPU
  double wait_us;          ///< from the end of its work to the next call of the CPU
  std::string source;      ///< of the figures
  std::string assumed;     ///< what nobody publishes
};

const std::vector<GpuCard>& gpu_cards();

/// The card that a renderer string ("vendor / renderer / version") names; null: none of gpu_cards().
const GpuCard* find_card(std::string_view description);

/// Milliseconds. They add up: nothing is taken to go on beside anything else.
struct GpuPrediction {
  double drawing_ms = 0, binning_ms = 0;  ///< each by the slowest of what goes on in it at the same time
  double bus_ms = 0, waiting_ms = 0;
  double submitting_ms = 0;  ///< calls of OpenGL
  double cpu_part_ms = 0;    ///< as it was measured

  double total_ms() const {
    return drawing_ms + binning_ms + bus_ms + waiting_ms + submitting_ms + cpu_part_ms;
  }
};

GpuPrediction predict(const GpuWork& work, const GpuCard& card);

/// What predict() takes for granted of the shaders and of drivers. The counts of operations and bytes are
/// those of the shaders, by hand; times of calls were measured on an H200 (docs/benchmark.md); the rest is
/// assumed.
namespace assumed {
inline constexpr double attained_share = 1.0 / 3;  // of each published rate
inline constexpr double drawing_flop_per_pixel = 120;
inline constexpr double binning_flop_per_pixel = 400;
inline constexpr double drawing_bytes_per_pixel =
    24;  // 16 of the sample, and its depth, which is cleared too
inline constexpr double binning_bytes_per_pixel =
    45;                                              // read by bins, by those of every second sample, by rows
inline constexpr double summing_bytes_per_bin = 40;  // of a pass: two sums read and begun anew, and the image
inline constexpr double pixel_words = 6;             // of 32 bits, which are written one by one: those bytes
inline constexpr double draw_call_us = 0.7;
inline constexpr double view_us = 0.5;
inline constexpr double pass_us = 120;  // a dozen dispatches, clears and copies, one after the other
}  // namespace assumed

}  // namespace sonard::bench
