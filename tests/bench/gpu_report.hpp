// SPDX-License-Identifier: Apache-2.0
// Measures engine `gpu` by stages, beside engine `cpu`, and writes a page with times, work and predictions.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/gpu_cost.hpp"
#include "tests/bench/measurements.hpp"
#include "tests/bench/points.hpp"
#include "tests/bench/reference.hpp"
#include "tests/scenes/scenes.hpp"

namespace sonard::bench {

struct GpuReportOptions {
  std::vector<std::string> scenes{};   ///< those whose names start so; empty: all of the report
  std::filesystem::path references{};  ///< images of the oracle
  bool only_gpu = false;               ///< otherwise both engines in turns, so that other load slows both
  double rate_hz = 0;                  ///< of the pings; 0: back to back
  int pings = 31;                      ///< at most, for each median
  int repeats = 0;                     ///< of each image, which must have the same bits
  int group = 0, segments = 0;         ///< GpuOptions
  std::filesystem::path images{};      ///< gets an image for each row; empty: none is written
  std::filesystem::path like{};        ///< images of another device to compare with; empty: none
};

/// The contents of a report.
struct GpuReport {
  std::string machine;      ///< describe_machine()
  std::string gpu;          ///< hardware of engine `gpu`: "gpu, vendor / renderer / version"
  std::string gpu_problem;  ///< why engine `gpu` is not available; empty: it is
  struct Row {
    std::string scene, preset;
    render::PingStatistics work{};  ///< of one ping; without dispatches if there is no engine `gpu`
    StageTimes times{};             ///< medians
  };
  std::vector<Row> rows;
  Measurements results;
};

/// Adds a scene. If engine `gpu` is not available, only `cpu` is measured.
/// @param reference null: no errors are computed
void measure_engines(const test::Scene& scene, const std::vector<Point>& points, const Reference* reference,
                     const GpuReportOptions& options, GpuReport& report);

/// Measures the scenes of the project's targets and three more, in `fast` and `default`. Takes minutes if
/// OpenGL runs on two cores. Prints a line of progress for each point to stderr.
GpuReport make_gpu_report(const GpuReportOptions& options);

/// The report as Markdown.
std::string format_gpu_report(const GpuReport& report);

}  // namespace sonard::bench
