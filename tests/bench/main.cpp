// SPDX-License-Identifier: Apache-2.0
// sonard_bench: run time against error, on the scenes of tests/scenes (docs/benchmark.md).
#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "renderer/renderer_options.hpp"
#include "tests/bench/campaign.hpp"
#include "tests/bench/demo_ping.hpp"
#include "tests/bench/gpu_report.hpp"
#include "tests/bench/machine.hpp"
#include "tests/bench/plans.hpp"
#include "tests/bench/quick_table.hpp"
#include "tests/bench/recording_cost.hpp"

namespace sonard::bench {
namespace {

struct Options {
  bool quick = false;
  bool company = false;
  std::string json;
  std::string gpu_report_file;
  GpuReportOptions gpu_report;
  std::string engine = "both";
  std::string references = SONARD_SOURCE_DIR "/tests/data/oracle";
  std::vector<std::string> scenes;
};

std::vector<render::EngineKind> engines_of(const std::string& name) {
  std::vector<render::EngineKind> engines;
  for (const render::EngineKind engine : {render::EngineKind::cpu, render::EngineKind::gpu}) {
    if (name == "both" || name == render::name_of(engine)) {
      engines.push_back(engine);
    }
  }
  return engines;
}

void run_gpu_report(const Options& options) {
  GpuReportOptions report_options = options.gpu_report;
  report_options.scenes = options.scenes;
  report_options.references = options.references;
  const GpuReport report = make_gpu_report(report_options);
  write_text(format_gpu_report(report), options.gpu_report_file);
  if (!options.json.empty()) {
    write_json(report.results, options.json);
  }
}

/// Replaces this process by a script of tests/bench. Does not return.
[[noreturn]] void go_on_as(const std::string& script, const std::string& argument) {
  std::fflush(stdout);
  execlp("python3", "python3", (SONARD_SOURCE_DIR "/tests/bench/" + script).c_str(), argument.c_str(),
         nullptr);
  throw std::runtime_error("python3 cannot be run");
}

[[noreturn]] void run_company() {
  fmt::print("{}", describe_machine());
  go_on_as("company.py", std::filesystem::canonical("/proc/self/exe").parent_path());
}

void run(const Options& options) {
  fmt::print("{}", describe_machine());
  const std::vector<render::EngineKind> engines = engines_of(options.engine);
  Measurements results;
  const bool demo_is_wanted =
      options.scenes.empty() || std::ranges::any_of(options.scenes, [](const std::string& s) {
        return demo_ping.scene.starts_with(s);
      });
  if (options.engine != "gpu" && demo_is_wanted) {
    measure_demo_ping(results, {20, 101, 3.0}, options.quick ? 0 : 24);
  }
  Campaign campaign(engines, options.references);
  if (options.quick) {
    run_quick(campaign);
  } else {
    run_sweep(campaign, options.scenes);
  }
  for (const Measurement& m : campaign.results().all()) {
    results.add(m.subject, m.metric, m.value, m.unit);
  }
  if (options.scenes.empty()) {
    measure_recording(results);
  }
  for (const render::EngineKind engine : engines) {
    const std::string name(render::name_of(engine));
    const auto description = campaign.descriptions().find(name);
    if (description != campaign.descriptions().end()) {
      fmt::print("\n{}\n", description->second);
    }
    fmt::print("{}", format_quick(quick_rows(results, name)));
  }
  if (options.scenes.empty()) {
    fmt::print("\n{}", describe_recording(results));
  }
  if (!options.json.empty()) {
    write_json(results, options.json);
  }
  if (options.quick && !is_for_one_instruction_set()) {
    go_on_as("instruction_sets.py", "--built");
  }
}

}  // namespace
}  // namespace sonard::bench

int main(int argc, char** argv) {
  sonard::bench::Options options;
  CLI::App app("Measures the time of a ping and the error of its image.");
  app.add_flag(
      "--quick", options.quick,
      "Only the main scenes and the demo's ping, in a minute or two, and the time with each set of vector "
      "instructions (tests/bench/instruction_sets.py)");
  app.add_flag("--company", options.company,
               "Pings a second of the demo beside 0, 1, 2 and 4 busy processes, and of `sonard render`; two "
               "minutes (tests/bench/company.py)")
      ->excludes("--quick");
  app.add_option("--json", options.json,
                 "File for a flat list of {scene, engine, preset, metric, value, unit}");
  app.add_option("--engine", options.engine, "Which engines to measure")
      ->check(CLI::IsMember({"both", "gpu", "cpu"}))
      ->capture_default_str();
  CLI::Option* const report =
      app.add_option(
             "--gpu-report", options.gpu_report_file,
             "Measures both engines in turns, engine gpu by stages, in minutes, and writes a page about "
             "them into this file")
          ->excludes("--quick", "--engine");
  app.add_flag("--only-gpu", options.gpu_report.only_gpu, "The report leaves out engine cpu")->needs(report);
  app.add_option("--rate", options.gpu_report.rate_hz, "Pings a second in the report; 0: back to back")
      ->needs(report)
      ->check(CLI::Range(0.0, 1000.0));
  app.add_option("--pings", options.gpu_report.pings, "At most so many pings for each median of the report")
      ->needs(report)
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--repeats", options.gpu_report.repeats,
                 "Repeats each image and counts those with other bits")
      ->needs(report)
      ->check(CLI::NonNegativeNumber);
  app.add_option("--group", options.gpu_report.group, "Invocations of a work group: 32, 64, 128; 0: as usual")
      ->needs(report)
      ->check(CLI::Range(0, 256));
  app.add_option("--segments", options.gpu_report.segments, "Segments of a slice seen at a time; 0: as usual")
      ->needs(report)
      ->check(CLI::Range(0, 2048));
  app.add_option("--images", options.gpu_report.images, "Folder for the images of the report")->needs(report);
  app.add_option("--like", options.gpu_report.like, "Folder of such images to compare with")->needs(report);
  app.add_option("--references", options.references, "Folder of the oracle's images")->capture_default_str();
  app.add_option("--scene", options.scenes, "Only scenes whose name starts so; not with --quick")
      ->excludes("--quick");
  CLI11_PARSE(app, argc, argv);
  try {
    if (options.company) {
      sonard::bench::run_company();
    } else if (options.gpu_report_file.empty()) {
      sonard::bench::run(options);
    } else {
      sonard::bench::run_gpu_report(options);
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "sonard_bench: {}\n", error.what());
    return 1;
  }
  return 0;
}
