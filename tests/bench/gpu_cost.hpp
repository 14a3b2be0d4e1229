// SPDX-License-Identifier: Apache-2.0
// The work of a ping on engine `gpu`, and its predicted time by the card's published rates.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/ping.hpp"
#include "tests/bench/measurements.hpp"

namespace sonard::bench {

/// The work of one ping. All are whole numbers, except the last.
struct GpuWork {
  double passes = 0, views = 0, draw_calls = 0, triangles = 0, pixels = 0, samples = 0;
  double atomic_additions = 0;
  double uploaded_kib = 0, read_back_kib = 0;
  double synchronisations = 0;
  double cpu_part_ms = 0;  ///< measured time of the CPU's own work, the same for all cards
};

/// Time of a ping of `total_s` outside drawing and binning, plus the CPU's own part of these two.
double cpu_part_s(double total_s, const render::PingStatistics& statistics);

GpuWork work_of(const render::PingStatistics& statistics, double cpu_part_ms);

/// Adds each count as a metric. Does nothing for a ping without passes, because only engine `gpu` has passes.
void add_work(Measurements& results, const Subject& subject, const GpuWork& work);

/// The work that add_work() added for a subject; nullopt if it did not.
std::optional<GpuWork> find_work(const Measurements& results, const Subject& subject);

/// A table of all subjects with work, for a terminal.
std::string format_work(const Measurements& results);

/// A card by its published rates.
struct GpuCard {
  std::string name;
  std::string renderer;                             ///< text in the renderer string of its OpenGL
  double drawing_flop_per_s, computing_flop_per_s;  ///< of fragment and compute shaders, 32-bit
  double pixels_per_s;                              ///< written, 32-bit
  double triangles_per_s;
  double additions_per_s;  ///< 32-bit atomics on different words of memory
  double memory_bytes_per_s;
  double bus_bytes_per_s;  ///< one way between CPU and GPU
  double wait_us;          ///< from the end of its work to the next call of the CPU
  std::string source;      ///< of the published figures
  std::string assumed;     ///< the unpublished figures
};

const std::vector<GpuCard>& gpu_cards();

/// The card in a renderer string ("vendor / renderer / version"); null if gpu_cards() does not have it.
const GpuCard* find_card(std::string_view description);

/// Predicted times in milliseconds. They add up: no two parts are assumed to overlap.
struct GpuPrediction {
  double drawing_ms = 0, binning_ms = 0;  ///< each by its slowest resource
  double bus_ms = 0, waiting_ms = 0;
  double submitting_ms = 0;  ///< OpenGL calls
  double cpu_part_ms = 0;    ///< measured

  double total_ms() const {
    return drawing_ms + binning_ms + bus_ms + waiting_ms + submitting_ms + cpu_part_ms;
  }
};

GpuPrediction predict(const GpuWork& work, const GpuCard& card);

/// Assumptions of predict() about shaders and drivers. Operations and bytes were counted by hand in the
/// shaders. Times of calls were measured on an H200 (docs/benchmark.md). The rest is assumed.
namespace assumed {
inline constexpr double attained_share = 1.0 / 3;  // of each published rate
inline constexpr double drawing_flop_per_pixel = 120;
inline constexpr double binning_flop_per_pixel = 400;
inline constexpr double drawing_bytes_per_pixel =
    24;  // 16 for the sample, and its depth, which is also cleared
inline constexpr double binning_bytes_per_pixel =
    45;  // read by bins, by the bins of every second sample, and by rows
inline constexpr double summing_bytes_per_bin = 40;  // per pass: two sums read and reset, and the image
inline constexpr double pixel_words = 6;  // 32-bit words, written one by one: drawing_bytes_per_pixel
inline constexpr double draw_call_us = 0.7;
inline constexpr double view_us = 0.5;
inline constexpr double pass_us = 120;  // a dozen dispatches, clears and copies, one after the other
}  // namespace assumed

}  // namespace sonard::bench
