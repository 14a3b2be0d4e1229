// SPDX-License-Identifier: Apache-2.0
// Measures both engines in turns, and writes a page with times, work of the GPU, and predicted times of
// cards.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/measurements.hpp"
#include "tests/bench/points.hpp"
#include "tests/bench/reference.hpp"
#include "tests/bench/timing.hpp"
#include "tests/scenes/scenes.hpp"

namespace sonard::bench {

/// The contents of a report.
struct GpuReport {
  std::string machine;      ///< describe_machine()
  std::string gpu;          ///< hardware of engine `gpu`: "gpu, vendor / renderer / version"
  std::string gpu_problem;  ///< why engine `gpu` is not available; empty: it is
  Measurements results;
};

/// Adds a scene. The engines render pings in turns, so that other load slows both. If engine `gpu` is not
/// available, only `cpu` is measured.
/// @param reference null: no errors are computed
void measure_in_turns(const test::Scene& scene, const std::vector<Point>& points, const Reference* reference,
                      const Repetition& repetition, GpuReport& report);

/// Measures the scenes of the project's targets and three more, in `fast` and `default`. Takes minutes if
/// OpenGL runs on two cores. Prints a line of progress for each point to stderr.
/// @param only selects scenes whose names start with one of these; empty: all
GpuReport make_gpu_report(const std::filesystem::path& references, const std::vector<std::string>& only);

/// The report as Markdown.
std::string format_gpu_report(const GpuReport& report);

}  // namespace sonard::bench
