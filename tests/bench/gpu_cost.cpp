// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/gpu_cost.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "tests/bench/timing.hpp"

namespace sonard::bench {

namespace {

constexpr double ms_per_us = 1e-3;
constexpr double bytes_per_kib = 1024;
constexpr double bytes_per_bin = sizeof(float);

struct Column {
  const char* metric;
  double GpuWork::*count;
  const char* unit;
};

constexpr Column cost_columns[] = {
    {"passes", &GpuWork::passes, "count"},       {"synchronisations", &GpuWork::synchronisations, "count"},
    {"views", &GpuWork::views, "count"},         {"draw_calls", &GpuWork::draw_calls, "count"},
    {"triangles", &GpuWork::triangles, "count"}, {"pixels", &GpuWork::pixels, "count"},
    {"samples", &GpuWork::samples, "count"},     {"atomic_additions", &GpuWork::atomic_additions, "count"},
    {"uploaded", &GpuWork::uploaded_kib, "KiB"}, {"read_back", &GpuWork::read_back_kib, "KiB"},
    {"cpu_part_ms", &GpuWork::cpu_part_ms, "ms"}};

constexpr double tera = 1e12, giga = 1e9;

// Assumes one addition per clock and cache slice, and one triangle per clock and group of drawing processors.
// The numbers of slices and groups are published for few cards.
std::vector<GpuCard> make_cards() {
  return {
      {"GeForce RTX 3060 12 GB", "RTX 3060/", 12.7 * tera, 12.7 * tera, 85.3 * giga, 5.3 * giga, 42.7 * giga,
       360 * giga, 31.5 * giga, 30,
       "NVIDIA's page of the RTX 3060 (3584 cores, 1.78 GHz, 192 bits of GDDR6 at 15 Gbit/s); the GA102 "
       "white paper (16 pixels a clock in each group of processors, of which this card has three)",
       "24 additions and 3 triangles a clock, 16 lanes of PCIe 4.0, 30 us to wait"},
      {"Jetson AGX Orin 64 GB", "Orin (nvgpu)", 5.3 * tera, 5.3 * tera, 41.6 * giga, 2.6 * giga, 20.8 * giga,
       204.8 * giga, 204.8 * giga, 60,
       "NVIDIA's technical brief of the Jetson AGX Orin (2048 cores, 1.3 GHz, 5.3 TFLOP/s, 204.8 GB/s)",
       "32 pixels, 16 additions and 2 triangles a clock, memory that CPU and GPU share as the bus, 60 us to "
       "wait; smaller Orins have the same renderer string"},
      {"H200 SXM", "NVIDIA H200", 67 * tera * 4 / 132, 67 * tera, 47.5 * giga, 2.0 * giga, 158 * giga,
       4800 * giga, 63 * giga, 30,
       "NVIDIA's data sheet of the H200 (67 TFLOP/s, 4.8 TB/s, PCIe 5.0); the H100 white paper (132 "
       "multiprocessors, of which only 4, in two pairs, run shaders that draw)",
       "1.98 GHz; 24 pixels, 80 additions and 1 triangle a clock, 30 us to wait"}};
}

std::vector<Subject> subjects_with_work(const Measurements& results) {
  std::vector<Subject> found;
  for (const Measurement& measurement : results.all()) {
    if (measurement.metric == "passes") {
      found.push_back(measurement.subject);
    }
  }
  return found;
}

}  // namespace

double cpu_part_s(double total_s, const render::PingStatistics& statistics) {
  return total_s - statistics.visibility_s - statistics.binning_s + statistics.preparing_s;
}

GpuWork work_of(const render::PingStatistics& statistics, double cpu_part_ms) {
  const auto count = [](std::uint64_t number) { return static_cast<double>(number); };
  GpuWork work;
  work.passes = count(statistics.passes);
  work.views = count(statistics.views);
  work.draw_calls = count(statistics.draw_calls);
  work.triangles = count(statistics.triangles);
  work.pixels = count(statistics.pixels);
  work.samples = count(statistics.samples);
  work.atomic_additions = count(statistics.atomic_additions);
  work.uploaded_kib = count(statistics.bytes_uploaded) / bytes_per_kib;
  work.read_back_kib = count(statistics.bytes_read_back) / bytes_per_kib;
  work.synchronisations = count(statistics.synchronisations);
  work.cpu_part_ms = cpu_part_ms;
  return work;
}

void add_work(Measurements& results, const Subject& subject, const GpuWork& work) {
  for (const Column& column : cost_columns) {
    if (work.passes > 0) {
      results.add(subject, column.metric, work.*column.count, column.unit);
    }
  }
}

std::optional<GpuWork> find_work(const Measurements& results, const Subject& subject) {
  GpuWork work;
  for (const Column& column : cost_columns) {
    const auto value = results.find(subject, column.metric);
    if (!value) {
      return std::nullopt;
    }
    work.*column.count = *value;
  }
  return work;
}

std::string format_work(const Measurements& results) {
  std::string text;
  constexpr const char* line =
      "{:<18} {:<12} {:>6} {:>5} {:>6} {:>6} {:>9} {:>9} {:>9} {:>9} {:>8} {:>8} {:>8}\n";
  for (const Subject& subject : subjects_with_work(results)) {
    const std::optional<GpuWork> work = find_work(results, subject);
    if (!work) {
      continue;
    }
    if (text.empty()) {
      text = fmt::format(line, "work of gpu a ping", "preset", "passes", "waits", "views", "draws",
                         "triangl. k", "pixels k", "samples k", "adds k", "up KiB", "down KiB", "CPU ms");
    }
    const auto thousands = [](double count) { return fmt::format("{:.0f}", count / 1e3); };
    text += fmt::format(line, subject.scene, subject.preset, work->passes, work->synchronisations,
                        work->views, work->draw_calls, thousands(work->triangles), thousands(work->pixels),
                        thousands(work->samples), thousands(work->atomic_additions),
                        fmt::format("{:.0f}", work->uploaded_kib), fmt::format("{:.0f}", work->read_back_kib),
                        fmt::format("{:.2f}", work->cpu_part_ms));
  }
  return text;
}

const std::vector<GpuCard>& gpu_cards() {
  static const std::vector<GpuCard> cards = make_cards();
  return cards;
}

const GpuCard* find_card(std::string_view description) {
  for (const GpuCard& card : gpu_cards()) {
    if (description.find(card.renderer) != std::string_view::npos) {
      return &card;
    }
  }
  return nullptr;
}

GpuPrediction predict(const GpuWork& work, const GpuCard& card) {
  const auto ms = [](double amount, double per_s) {
    return ms_per_s * amount / (assumed::attained_share * per_s);
  };
  const double read_back_bytes = bytes_per_kib * work.read_back_kib;
  const double uploaded_bytes = bytes_per_kib * work.uploaded_kib;
  const double summing_bytes = assumed::summing_bytes_per_bin * work.passes * read_back_bytes / bytes_per_bin;
  GpuPrediction time;
  time.drawing_ms = std::max({ms(assumed::drawing_flop_per_pixel * work.pixels, card.drawing_flop_per_s),
                              ms(assumed::pixel_words * work.pixels, card.pixels_per_s),
                              ms(assumed::drawing_bytes_per_pixel * work.pixels, card.memory_bytes_per_s),
                              ms(work.triangles, card.triangles_per_s)});
  time.binning_ms =
      std::max({ms(assumed::binning_flop_per_pixel * work.pixels, card.computing_flop_per_s),
                ms(work.atomic_additions, card.additions_per_s),
                ms(assumed::binning_bytes_per_pixel * work.pixels + summing_bytes, card.memory_bytes_per_s)});
  time.bus_ms = ms(read_back_bytes + uploaded_bytes, card.bus_bytes_per_s);
  time.waiting_ms = ms_per_us * card.wait_us * work.synchronisations;
  time.submitting_ms = ms_per_us * (assumed::draw_call_us * work.draw_calls + assumed::view_us * work.views +
                                    assumed::pass_us * work.passes);
  time.cpu_part_ms = work.cpu_part_ms;
  return time;
}

}  // namespace sonard::bench
