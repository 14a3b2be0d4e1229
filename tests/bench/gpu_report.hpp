// SPDX-License-Identifier: Apache-2.0
// Both engines measured in turns, and one page with the times, the work of the GPU, and what cards would take
// for it.
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

/// What a report is made of.
struct GpuReport {
  std::string machine;      ///< describe_machine()
  std::string gpu;          ///< what engine `gpu` runs on: "gpu, vendor / renderer / version"
  std::string gpu_problem;  ///< why there is no engine `gpu`; empty: there is one
  Measurements results;
};

/// Adds a scene: pings of the one engine and of the other in turns, so that what else a machine does slows
/// both. Without engine `gpu` that of `cpu` alone is measured.
/// @param reference null: no errors
void measure_in_turns(const test::Scene& scene, const std::vector<Point>& points, const Reference* reference,
                      const Repetition& repetition, GpuReport& report);

/// The scenes of the project's targets and three more, in `fast` and `default`. Takes minutes where OpenGL
/// runs on two cores. A line of progress for each point goes to stderr.
/// @param only scenes whose name starts with one of these; empty: all.
GpuReport make_gpu_report(const std::filesystem::path& references, const std::vector<std::string>& only);

/// The page, in Markdown.
std::string format_gpu_report(const GpuReport& report);

}  // namespace sonard::bench
