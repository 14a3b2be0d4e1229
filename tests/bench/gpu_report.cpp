// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/gpu_report.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <thread>

#include "protocol/npy/npy_file.hpp"
#include "renderer/errors.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "tests/bench/image_error.hpp"
#include "tests/bench/machine.hpp"
#include "tests/bench/scene_run.hpp"
#include "tests/bench/timing.hpp"

namespace sonard::bench {

namespace {

constexpr double budget_s = 4;  // of the pings of a point
// `docking` comes first, because mesh files are read in forked processes before other threads exist.
constexpr const char* report_scenes[] = {"docking",    "plane",      "flat100k", "swell100k",
                                         "ripple100k", "b3_cluster", "swell1m"};

/// An engine with the times of its pings.
struct Engine {
  std::unique_ptr<render::SonarRenderer> renderer;
  Timing ping_ms{};
  std::map<std::string, Timing> stages_ms{};

  void ping(const render::PingRequest& request) {
    const double from_s = now_s();
    renderer->render_echo(request);
    const double ms = ms_per_s * (now_s() - from_s);
    const StageTimes& stages = renderer->last_statistics().gpu.stages_ms;
    ping_ms.add(ms);
    stages_ms[rest_stage].add(ms - total_ms(stages));
    for (const auto& [stage, stage_ms] : stages) {
      stages_ms[stage].add(stage_ms);
    }
  }
};

std::vector<Engine> make_engines(const test::Scene& scene, const GpuReportOptions& of_report,
                                 GpuReport& report) {
  std::vector<Engine> engines;
  for (const auto kind : {render::EngineKind::cpu, render::EngineKind::gpu}) {
    render::RendererOptions options{kind};
    options.gpu.time_stages = true;
    options.gpu.group = of_report.group;
    options.gpu.segments = of_report.segments;
    options.skip.turn_off(render::SkipRule::unchanged_scene);  // for check_image()
    try {
      if (kind == render::EngineKind::gpu || !of_report.only_gpu) {
        engines.push_back({std::make_unique<render::SonarRenderer>(scene.world, options)});
      }
      report.gpu = kind == render::EngineKind::gpu ? engines.back().renderer->engine_description() : "";
    } catch (const render::RendererError& error) {
      if (of_report.only_gpu) {
        throw;
      }
      report.gpu_problem = error.what();
    }
  }
  return engines;
}

std::string bytes_of(const render::EchoImage& image) {
  return {reinterpret_cast<const char*>(image.intensity.data()), image.intensity.size() * sizeof(float)};
}

/// Repeats an image, writes it, and compares it with the image of another device.
void check_image(Engine& engine, const render::PingRequest& request, const Subject& subject,
                 const GpuReportOptions& options, Measurements& results) {
  const render::EchoImage image = engine.renderer->render_echo(request);
  const std::string bytes = bytes_of(image), file = subject.scene + "-" + subject.preset + ".npy";
  int different = 0;
  for (int i = 0; i < options.repeats; ++i) {
    different += bytes_of(engine.renderer->render_echo(request)) == bytes ? 0 : 1;
  }
  results.add(subject, "different_repeats", different, "count");
  if (options.repeats > 0) {
    fmt::print(stderr, "{} {}: {} of {} repeats differ\n", subject.scene, subject.preset, different,
               options.repeats);
  }
  if (!options.images.empty()) {
    write_text(npy::header("<f4", image.beams, image.bins) + bytes, options.images / file);
  }
  if (!options.like.empty()) {
    const auto error = compare_images(image, read_npy(options.like / file));
    const double rms = error ? error->bin_rms : 0;
    results.add(subject, "rms_to_other_device", rms, "1");
    fmt::print(stderr, "{} {}: RMS to the other device {:.2g}\n", subject.scene, subject.preset, rms);
  }
}

/// Geometric mean of both bounds of a prediction.
StageTimes likely(const GpuReport::Row& row, const GpuCard& card) {
  return predict(row.work, card, std::sqrt(least_attained * most_attained));
}

GpuReport::Row row_of(const Engine& engine, const Subject& subject, Measurements& results) {
  GpuReport::Row row{subject.scene, subject.preset, engine.renderer->last_statistics()};
  for (const auto& [stage, timing] : engine.stages_ms) {
    row.times[stage] = timing.median();
    results.add(subject, stage + "_ms", timing.median(), "ms");
  }
  for (const auto& [name, count] : counts_of(row.work)) {
    results.add(subject, name, count, "count");
  }
  for (const GpuCard& card : gpu_cards()) {
    results.add({row.scene, card.name, row.preset}, "predicted_ms", total_ms(likely(row, card)), "ms");
  }
  return row;
}

}  // namespace

void measure_engines(const test::Scene& scene, const std::vector<Point>& points, const Reference* reference,
                     const GpuReportOptions& options, GpuReport& report) {
  std::vector<Engine> engines = make_engines(scene, options, report);
  const Repetition repetition{std::min(7, options.pings), options.pings, budget_s};
  for (const Point& point : points) {
    render::PingRequest still = scene.request();
    point.apply(still.settings);
    render::PingRequest moving = still;
    for (Engine& engine : engines) {
      engine.renderer->render_echo(still);  // uploads the data that stays on the GPU between pings
      engine.ping_ms = {};
      engine.stages_ms.clear();
    }
    const double start_s = now_s();
    for (int i = 0; repetition.wants_more(i, start_s); ++i) {
      if (options.rate_hz > 0) {
        std::this_thread::sleep_for(std::chrono::duration<double>(1 / options.rate_hz));
      }
      move_to_timed_pose(moving, scene.T_world_sonar, i);
      std::ranges::for_each(engines, [&](Engine& engine) { engine.ping(moving); });
    }
    for (Engine& engine : engines) {
      const Subject subject{scene.name, std::string(render::name_of(engine.renderer->engine())), point.name};
      report.results.add(subject, "ping_ms", engine.ping_ms.median(), "ms");
      report.results.add(subject, "ping_ms_p10", engine.ping_ms.quantile(0.1), "ms");
      report.results.add(subject, "ping_ms_p90", engine.ping_ms.quantile(0.9), "ms");
      if (reference != nullptr) {
        add_errors(report.results, subject, point, engine.renderer->render_echo(still), *reference);
      }
      if (subject.engine == "gpu") {
        report.rows.push_back(row_of(engine, subject, report.results));
        check_image(engine, still, subject, options, report.results);
      } else if (!report.gpu_problem.empty()) {
        report.rows.push_back({scene.name, point.name});
      }
      fmt::print(stderr, "{:<14} {:<4} {:<8} {:>9.3g} ms\n", subject.scene, subject.engine, subject.preset,
                 engine.ping_ms.median());
    }
  }
}

GpuReport make_gpu_report(const GpuReportOptions& options) {
  GpuReport report;
  report.machine = describe_machine();
  for (const std::string name : report_scenes) {
    const auto is_asked_for = [&](const std::string& start) { return name.rfind(start, 0) == 0; };
    if (options.scenes.empty() || std::ranges::any_of(options.scenes, is_asked_for)) {
      const test::Scene scene = test::make_scene(name);
      const std::optional<Reference> reference = find_reference(scene, options.references);
      measure_engines(scene, {preset_points().front(), default_point()}, reference ? &*reference : nullptr,
                      options, report);
    }
  }
  return report;
}

std::string format_gpu_report(const GpuReport& report) {
  std::string text = fmt::format(
      "# Engine `gpu`\n\n```\n{}engine    {}\n```\n\nOne mean echo, ms. `cpu` and `gpu`: medians here, and "
      "where 80 % of the pings lie. Cards: predictions if {:.0f} and {:.0f} % of their instructions are "
      "attained, and the stages in between. RMS: of image / reference - 1.\n\n"
      "| scene | preset | where | ping |",
      report.machine, report.gpu_problem.empty() ? report.gpu : report.gpu_problem, 100 * most_attained,
      100 * least_attained);
  std::string rule = "|---|---|---|---|";
  for (const std::string& stage : gpu_stages()) {
    text += " " + stage.substr(0, stage.find('.')) + " |";
    rule += "---|";
  }
  text += " RMS % |\n" + rule + "---|\n";
  const auto digits = [](std::optional<double> value) { return value ? fmt::format("{:.3g}", *value) : "-"; };
  for (const GpuReport::Row& row : report.rows) {
    const auto add = [&](const std::string& where, const std::string& ping, const StageTimes& times,
                         std::optional<double> rms) {
      text += fmt::format("| `{}` | {} | {} | {} |", row.scene, row.preset, where, ping);
      for (const std::string& stage : gpu_stages()) {
        text += fmt::format(" {} |", times.contains(stage) ? digits(times.at(stage)) : "-");
      }
      text += fmt::format(" {} |\n", rms ? digits(100 * *rms) : "-");
    };
    for (const std::string engine : {"cpu", "gpu"}) {
      const auto value = [&](const char* metric) {
        return report.results.find({row.scene, engine, row.preset}, metric);
      };
      if (value("ping_ms")) {
        add("`" + engine + "`",
            fmt::format("{} ({}-{})", digits(value("ping_ms")), digits(value("ping_ms_p10")),
                        digits(value("ping_ms_p90"))),
            engine == "gpu" ? row.times : StageTimes{}, value("bin_rms"));
      }
    }
    for (const GpuCard& card : gpu_cards()) {
      if (report.gpu_problem.empty()) {
        add(card.name,
            fmt::format("{:.2g}-{:.2g}", total_ms(predict(row.work, card, most_attained)),
                        total_ms(predict(row.work, card, least_attained))),
            likely(row, card), {});
      }
    }
  }
  for (const GpuCard& card : gpu_cards()) {
    text += fmt::format("\n{}: {}\n", card.name, card.source);
  }
  return text;
}

}  // namespace sonard::bench
