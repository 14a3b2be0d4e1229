// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/gpu_cost.hpp"

#include <gtest/gtest.h>

#include "tests/bench/gpu_report.hpp"

namespace sonard::bench {
namespace {

const GpuCard& h200() {
  return gpu_cards().front();
}

// 1000 slices of 200 segments in 5 rounds, 100,000 patches, a million range bins.
render::PingStatistics round_numbers() {
  render::PingStatistics ping;
  ping.gpu.work.dispatches = 31;
  ping.gpu.work.rounds = 5;
  ping.gpu.work.slices = 1000;
  ping.gpu.work.segments = 200'000;
  ping.gpu.work.additions = 1'000'000;
  ping.samples = 100'000;
  ping.gpu.bytes_read_back = 4'000'000;
  ping.gpu.synchronisations = ping.gpu.passes = 1;
  return ping;
}

TEST(GpuCost, NoWorkTakesNoTime) {
  for (const GpuCard& card : gpu_cards()) {
    EXPECT_EQ(total_ms(predict({}, card, 0.1)), 0) << card.name;
  }
}

// By hand, with 16,896 lanes x 1.98 GHz x 0.1 = 3.3454e12 instructions per second.
TEST(GpuCost, PredictsWhatOneComputesByHand) {
  const StageTimes times = predict(round_numbers(), h200(), 0.1);
  EXPECT_NEAR(times.at("see.comp"), 0.06995 + 0.17677,
              1e-4);  // (650 + 2.6 x 200) x 200,000; 5 x 70,000 cycles
  EXPECT_NEAR(times.at("refine.comp"), 0.00628 + 0.10101, 1e-4);  // 21,000 x 1000; 5 x 40,000 cycles
  EXPECT_NEAR(times.at("pieces.comp"), 0.02391, 1e-4);            // 800 x 100,000
  EXPECT_NEAR(times.at("patches.comp"), 0.00448, 1e-4);           // 150 x 100,000
  EXPECT_NEAR(times.at("bin.comp"), 0.01644, 1e-4);               // 550 x 100,000
  EXPECT_NEAR(times.at("sums.comp"), 0.02391, 1e-4);              // 80 x 1,000,000
  EXPECT_NEAR(times.at("rest"), 0.0992 + 0.03 + 0.10582 + 0.1, 1e-4);
  EXPECT_EQ(times.size(), gpu_stages().size());
}

TEST(GpuCost, AtomicsAndMemoryMayTakeLonger) {
  render::PingStatistics ping = round_numbers();
  ping.gpu.work.additions = 79'200'000;  // a millisecond at 40 a clock
  EXPECT_NEAR(predict(ping, h200(), 0.1).at("bin.comp"), 1, 1e-9);
  GpuCard card = h200();
  card.memory_gb_per_s = 0.1;  // 60 MB at 0.06 GB/s
  EXPECT_NEAR(predict(ping, card, 0.1).at("sums.comp"), 1000, 1e-6);
}

// Counts of an instrumented engine `cpu` for `docking`, and its 4.7e9 lane instructions.
TEST(GpuCost, HasTheInstructionsOfTheDockingStation) {
  render::PingStatistics ping;
  ping.gpu.work.slices = 5868;
  ping.gpu.work.segments = 5868ULL * 360;
  ping.samples = 786'000;
  GpuCard card = h200();
  card.lanes = card.clock_ghz = 1;  // a nanosecond for each instruction
  card.memory_gb_per_s = card.additions_per_clock = 1e30;
  const StageTimes times = predict(ping, card, 1);
  double instructions = 0;
  for (const char* stage : {"see.comp", "pieces.comp", "patches.comp", "bin.comp"}) {
    instructions += 1e6 * times.at(stage);
  }
  EXPECT_NEAR(instructions / 4.7e9, 1, 0.1);
}

// ---- the page

GpuReport report_of(const std::string& gpu) {
  GpuReport report;
  report.machine = "processor of a test\n";
  report.gpu = gpu;
  for (const char* engine : {"cpu", "gpu"}) {
    const Subject subject{"scene", engine, "fast"};
    report.results.add(subject, "ping_ms", engine == std::string("cpu") ? 2 : 6, "ms");
    report.results.add(subject, "ping_ms_p10", 1, "ms");
    report.results.add(subject, "ping_ms_p90", 9, "ms");
  }
  report.rows.push_back({"scene", "fast", round_numbers(), {{"see.comp", 4}, {rest_stage, 2}}});
  return report;
}

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(GpuReportPage, HasPredictionsBesideMeasurements) {
  const std::string page = format_gpu_report(report_of("gpu, Mesa / llvmpipe / 4.5"));
  EXPECT_TRUE(holds(page, "processor of a test"));
  EXPECT_TRUE(holds(page, "llvmpipe"));
  EXPECT_TRUE(holds(page, "| `scene` | fast | `cpu` | 2 (1-9) | - |")) << page;
  EXPECT_TRUE(holds(page, "| `scene` | fast | `gpu` | 6 (1-9) | - | - | - | 4 | - | - | - | - | - | 2 | - |"))
      << page;
  for (const GpuCard& card : gpu_cards()) {
    EXPECT_TRUE(holds(page, "| `scene` | fast | " + card.name + " | ")) << page;
    EXPECT_TRUE(holds(page, card.source));
  }
}

TEST(GpuReportPage, SaysWhyThereIsNoEngineOfTheGpu) {
  GpuReport report;
  report.gpu_problem = "EGL: no device";
  report.rows.push_back({"scene", "fast"});
  report.results.add({"scene", "cpu", "fast"}, "ping_ms", 2, "ms");
  const std::string page = format_gpu_report(report);
  EXPECT_TRUE(holds(page, "EGL: no device"));
  EXPECT_TRUE(holds(page, "| `cpu` | 2 (---) |")) << page;
  EXPECT_FALSE(holds(page, "| fast | H200 |"));
}

}  // namespace
}  // namespace sonard::bench
