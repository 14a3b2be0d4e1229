// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/gpu_cost.hpp"

#include <gtest/gtest.h>

#include "tests/bench/gpu_report.hpp"

namespace sonard::bench {
namespace {

constexpr double attained = assumed::attained_share;

/// A card that takes no time, except for the properties that a test slows down.
GpuCard instant() {
  return {"instant", "-", 1e30, 1e30, 1e30, 1e30, 1e30, 1e30, 1e30, 0, "nowhere", "everything"};
}

GpuWork million_pixels() {
  GpuWork work;
  work.passes = 1;
  work.pixels = 1e6;
  work.triangles = 1e6;
  work.atomic_additions = 4e6;
  return work;
}

TEST(GpuCost, NoWorkTakesNoTime) {
  for (const GpuCard& card : gpu_cards()) {
    EXPECT_EQ(predict({}, card).total_ms(), 0) << card.name;
  }
}

TEST(GpuCost, DrawingTakesAsLongAsItsSlowestPart) {
  GpuCard card = instant();
  card.drawing_flop_per_s = assumed::drawing_flop_per_pixel * 1e9 / attained;
  EXPECT_NEAR(predict(million_pixels(), card).drawing_ms, 1, 1e-9);
  card.pixels_per_s = assumed::pixel_words * 0.5e9 / attained;
  EXPECT_NEAR(predict(million_pixels(), card).drawing_ms, 2, 1e-9);
  card.triangles_per_s = 0.25e9 / attained;
  EXPECT_NEAR(predict(million_pixels(), card).drawing_ms, 4, 1e-9);
  card.memory_bytes_per_s = assumed::drawing_bytes_per_pixel * 0.125e9 / attained;
  EXPECT_NEAR(predict(million_pixels(), card).drawing_ms, 8, 1e-9);
}

TEST(GpuCost, BinningTakesAsLongAsItsSlowestPart) {
  GpuCard card = instant();
  card.computing_flop_per_s = assumed::binning_flop_per_pixel * 1e9 / attained;
  EXPECT_NEAR(predict(million_pixels(), card).binning_ms, 1, 1e-9);
  card.additions_per_s = 2e9 / attained;
  EXPECT_NEAR(predict(million_pixels(), card).binning_ms, 2, 1e-9);
  card.memory_bytes_per_s = assumed::binning_bytes_per_pixel * 0.25e9 / attained;
  EXPECT_NEAR(predict(million_pixels(), card).binning_ms, 4, 1e-9);
}

TEST(GpuCost, EveryPassSumsTheImage) {
  GpuWork work;
  work.passes = 3;
  work.read_back_kib = 4;  // 1024 bins
  GpuCard card = instant();
  card.memory_bytes_per_s = 3 * 1024 * assumed::summing_bytes_per_bin / attained;
  EXPECT_NEAR(predict(work, card).binning_ms, 1000, 1e-6);
}

TEST(GpuCost, BytesWaitsCallsAndTheCpuAddUp) {
  GpuWork work;
  work.uploaded_kib = 600;
  work.read_back_kib = 400;
  work.synchronisations = 3;
  work.draw_calls = 1000;
  work.views = 10;
  work.passes = 2;
  work.cpu_part_ms = 0.5;
  GpuCard card = instant();
  card.bus_bytes_per_s = 1024e6 / attained;
  card.wait_us = 100;
  const GpuPrediction time = predict(work, card);
  EXPECT_NEAR(time.bus_ms, 1, 1e-9);
  EXPECT_NEAR(time.waiting_ms, 0.3, 1e-9);
  EXPECT_NEAR(time.submitting_ms, assumed::draw_call_us + assumed::view_us / 100 + assumed::pass_us / 500,
              1e-9);
  EXPECT_NEAR(time.total_ms(), 1 + 0.3 + time.submitting_ms + 0.5, 1e-9);
}

TEST(GpuCost, OfTheCpuIsWhatIsNeitherDrawnNorBinned) {
  render::PingStatistics statistics;
  statistics.visibility_s = 2;
  statistics.binning_s = 3;
  statistics.preparing_s = 0.5;
  EXPECT_DOUBLE_EQ(cpu_part_s(6, statistics), 1.5);
}

TEST(GpuCost, CardsAreKnownByTheirRendererString) {
  const GpuCard* card = find_card("gpu, NVIDIA Corporation / NVIDIA GeForce RTX 3060/PCIe/SSE2 / 4.6.0");
  ASSERT_NE(card, nullptr);
  EXPECT_EQ(card->name, "GeForce RTX 3060 12 GB");
  EXPECT_EQ(find_card("gpu, NVIDIA Corporation / NVIDIA GeForce RTX 3060 Ti/PCIe/SSE2 / 4.6.0"), nullptr);
  EXPECT_EQ(find_card("gpu, Mesa / llvmpipe (LLVM 15.0.6, 256 bits) / 4.5"), nullptr);
}

TEST(GpuCost, WorkGoesThroughTheListOfMeasurements) {
  render::PingStatistics statistics;
  statistics.passes = 2;
  statistics.pixels = 7000;
  statistics.bytes_uploaded = 512;
  statistics.atomic_additions = 9000;
  Measurements results;
  const Subject subject{"scene", "gpu", "fast"};
  add_work(results, subject, work_of(statistics, 1.25));
  const auto found = find_work(results, subject);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->passes, 2);
  EXPECT_EQ(found->pixels, 7000);
  EXPECT_EQ(found->uploaded_kib, 0.5);
  EXPECT_EQ(found->atomic_additions, 9000);
  EXPECT_EQ(found->cpu_part_ms, 1.25);
  EXPECT_NE(format_work(results).find("scene"), std::string::npos);
}

TEST(GpuCost, AnEngineWithoutPassesHasNoWork) {
  Measurements results;
  const Subject subject{"scene", "cpu", "fast"};
  add_work(results, subject, work_of({}, 1));
  EXPECT_TRUE(results.all().empty());
  EXPECT_FALSE(find_work(results, subject));
  EXPECT_EQ(format_work(results), "");
}

// ---- the web page

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
  add_work(report.results, {"scene", "gpu", "fast"}, million_pixels());
  return report;
}

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(GpuReportPage, HasBothEnginesSideBySide) {
  const std::string page = format_gpu_report(report_of("gpu, Mesa / llvmpipe / 4.5"));
  EXPECT_TRUE(holds(page, "processor of a test"));
  EXPECT_TRUE(holds(page, "llvmpipe"));
  EXPECT_TRUE(holds(page, "| `scene` | fast | 2 (1-9) | 6 (1-9) | 3 | - | - |")) << page;
  EXPECT_FALSE(holds(page, "measured / predicted"));
  for (const GpuCard& card : gpu_cards()) {
    EXPECT_TRUE(holds(page, card.name));
    EXPECT_TRUE(holds(page, card.source));
  }
}

TEST(GpuReportPage, ComparesAKnownCardWithItsPrediction) {
  const std::string page =
      format_gpu_report(report_of("gpu, NVIDIA Corporation / NVIDIA H200/PCIe/SSE2 / 4.6.0"));
  EXPECT_TRUE(holds(page, "measured / predicted"));
  EXPECT_TRUE(holds(page, "Engine `gpu` ran on the H200 SXM."));
}

TEST(GpuReportPage, SaysWhyThereIsNoEngineOfTheGpu) {
  GpuReport report;
  report.gpu_problem = "EGL: no device";
  report.results.add({"scene", "cpu", "fast"}, "ping_ms", 2, "ms");
  const std::string page = format_gpu_report(report);
  EXPECT_TRUE(holds(page, "EGL: no device"));
  EXPECT_TRUE(holds(page, "| `scene` | fast | 2 (-"));
  EXPECT_FALSE(holds(page, "## Predictions"));
}

}  // namespace
}  // namespace sonard::bench
