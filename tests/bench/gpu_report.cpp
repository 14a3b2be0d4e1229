// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/gpu_report.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <memory>
#include <optional>

#include "renderer/errors.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "tests/bench/gpu_cost.hpp"
#include "tests/bench/machine.hpp"
#include "tests/bench/scene_run.hpp"

namespace sonard::bench {

namespace {

constexpr Repetition in_turns{7, 31, 4.0};  // of both engines together
// `docking` comes first, because mesh files are read in forked processes before other threads exist.
constexpr const char* report_scenes[] = {"docking",    "plane",      "flat100k", "swell100k",
                                         "ripple100k", "b3_cluster", "swell1m"};

/// One engine in one scene, with its times.
struct Turns {
  std::unique_ptr<render::SonarRenderer> renderer;
  Timing ping_ms{}, cpu_part_ms{};

  void ping(const render::PingRequest& request, bool timed) {
    const double from_s = now_s();
    renderer->render_echo(request);
    const double ping_s = now_s() - from_s;
    if (timed) {
      ping_ms.add(ms_per_s * ping_s);
      cpu_part_ms.add(ms_per_s * cpu_part_s(ping_s, renderer->last_statistics()));
    }
  }
};

std::vector<Turns> make_engines(const test::Scene& scene, GpuReport& report) {
  std::vector<Turns> engines;
  const auto make = [&](render::EngineKind kind) {
    engines.push_back({std::make_unique<render::SonarRenderer>(scene.world, render::RendererOptions{kind})});
  };
  make(render::EngineKind::cpu);
  try {
    make(render::EngineKind::gpu);
    report.gpu = engines.back().renderer->engine_description();
  } catch (const render::RendererError& error) {
    report.gpu_problem = error.what();
  }
  return engines;
}

void add_results(const Subject& subject, const Point& point, Turns& turns, const render::PingRequest& still,
                 const Reference* reference, Measurements& results) {
  const render::EchoImage& image = turns.renderer->render_echo(still);
  results.add(subject, "ping_ms", turns.ping_ms.median(), "ms");
  results.add(subject, "ping_ms_p10", turns.ping_ms.quantile(0.1), "ms");
  results.add(subject, "ping_ms_p90", turns.ping_ms.quantile(0.9), "ms");
  add_work(results, subject, work_of(turns.renderer->last_statistics(), turns.cpu_part_ms.median()));
  if (reference != nullptr) {
    add_errors(results, subject, point, image, *reference);
  }
}

// ---- the page

std::string three_digits(std::optional<double> value, double scale = 1) {
  return value ? fmt::format("{:.3g}", scale * *value) : "-";
}

/// The subjects of engine `cpu`, which always runs.
std::vector<Subject> rows_of(const Measurements& results) {
  std::vector<Subject> rows;
  for (const Measurement& measurement : results.all()) {
    if (measurement.metric == "ping_ms" && measurement.subject.engine == "cpu") {
      rows.push_back(measurement.subject);
    }
  }
  return rows;
}

Subject on_gpu(Subject subject) {
  subject.engine = "gpu";
  return subject;
}

std::string time_of(const Measurements& results, const Subject& subject) {
  const auto value = [&](const char* metric) { return three_digits(results.find(subject, metric)); };
  return results.find(subject, "ping_ms")
             ? fmt::format("{} ({}-{})", value("ping_ms"), value("ping_ms_p10"), value("ping_ms_p90"))
             : "-";
}

std::string times_table(const Measurements& results) {
  std::string text =
      "| scene | preset | `cpu` ms | `gpu` ms | gpu / cpu | RMS of `cpu` % | RMS of `gpu` % |\n"
      "|---|---|---|---|---|---|---|\n";
  for (const Subject& cpu : rows_of(results)) {
    const Subject gpu = on_gpu(cpu);
    const auto cpu_ms = results.find(cpu, "ping_ms"), gpu_ms = results.find(gpu, "ping_ms");
    text += fmt::format(
        "| `{}` | {} | {} | {} | {} | {} | {} |\n", cpu.scene, cpu.preset, time_of(results, cpu),
        time_of(results, gpu), gpu_ms ? three_digits(*gpu_ms / *cpu_ms) : "-",
        three_digits(results.find(cpu, "bin_rms"), 100), three_digits(results.find(gpu, "bin_rms"), 100));
  }
  return text;
}

std::string work_table(const Measurements& results) {
  std::string text =
      "| scene | preset | passes | waits | views | draw calls | triangles k | pixels k | samples k | atomic "
      "additions k | up KiB | down KiB | CPU part ms "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Subject& row : rows_of(results)) {
    if (const auto work = find_work(results, on_gpu(row))) {
      text += fmt::format(
          "| `{}` | {} | {} | {} | {} | {} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.2f} "
          "|\n",
          row.scene, row.preset, work->passes, work->synchronisations, work->views, work->draw_calls,
          work->triangles / 1e3, work->pixels / 1e3, work->samples / 1e3, work->atomic_additions / 1e3,
          work->uploaded_kib, work->read_back_kib, work->cpu_part_ms);
    }
  }
  return text;
}

/// @param here whether the measurements ran on this card
std::string prediction_table(const Measurements& results, const GpuCard& card, bool here) {
  std::string text =
      fmt::format("### {}\n\nPublished: {}. Assumed: {}.\n\n", card.name, card.source, card.assumed);
  text += "| scene | preset | draw | bin | bus | waits | calls | CPU part | predicted ms |";
  text += here ? " measured ms | measured / predicted |\n|---|---|---|---|---|---|---|---|---|---|---|\n"
               : "\n|---|---|---|---|---|---|---|---|---|\n";
  for (const Subject& row : rows_of(results)) {
    const auto work = find_work(results, on_gpu(row));
    if (!work) {
      continue;
    }
    const GpuPrediction time = predict(*work, card);
    text += fmt::format("| `{}` | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |",
                        row.scene, row.preset, time.drawing_ms, time.binning_ms, time.bus_ms, time.waiting_ms,
                        time.submitting_ms, time.cpu_part_ms, time.total_ms());
    const double measured_ms = results.find(on_gpu(row), "ping_ms").value_or(0);
    text += here ? fmt::format(" {:.2f} | {:.2f} |\n", measured_ms, measured_ms / time.total_ms()) : "\n";
  }
  return text;
}

std::string assumptions() {
  return fmt::format(
      "Of each published rate {:.0f} % are taken to be attained. Operations: {} a pixel to draw it, {} to "
      "bin it "
      "and to estimate its error. Bytes: {} and {} a pixel, {} a bin and pass. Calls: {} us each that draws, "
      "{} "
      "us a view, {} us a pass. The CPU part is measured: a ping less drawing and binning, but with culling "
      "and laying out "
      "grids. Parts are added up, as if nothing went on beside anything else.\n",
      100 * assumed::attained_share, assumed::drawing_flop_per_pixel, assumed::binning_flop_per_pixel,
      assumed::drawing_bytes_per_pixel, assumed::binning_bytes_per_pixel, assumed::summing_bytes_per_bin,
      assumed::draw_call_us, assumed::view_us, assumed::pass_us);
}

void report_progress(const Measurements& results, const Subject& subject) {
  fmt::print(stderr, "{:<14} {:<8} {:<8} {:>24} ms\n", subject.scene, subject.engine, subject.preset,
             time_of(results, subject));
}

}  // namespace

void measure_in_turns(const test::Scene& scene, const std::vector<Point>& points, const Reference* reference,
                      const Repetition& repetition, GpuReport& report) {
  std::vector<Turns> engines = make_engines(scene, report);
  for (const Point& point : points) {
    const render::Pose start = scene.T_world_sonar;
    render::PingRequest still = scene.request();
    point.apply(still.settings);
    render::PingRequest moving = still;
    for (Turns& turns : engines) {
      turns.ping_ms = turns.cpu_part_ms = {};
    }
    for (Turns& turns : engines) {
      turns.ping(still, false);  // uploads the data that stays on the GPU between pings
    }
    const double start_s = now_s();
    for (int i = 0; repetition.wants_more(i, start_s); ++i) {
      move_to_timed_pose(moving, start, i);
      for (Turns& turns : engines) {
        turns.ping(moving, true);
      }
    }
    for (Turns& turns : engines) {
      const std::string engine(render::name_of(turns.renderer->engine()));
      const Subject subject{scene.name, engine, point.name};
      add_results(subject, point, turns, still, reference, report.results);
      report_progress(report.results, subject);
    }
  }
}

GpuReport make_gpu_report(const std::filesystem::path& references, const std::vector<std::string>& only) {
  GpuReport report;
  report.machine = describe_machine();
  std::vector<Point> points = preset_points();
  points.erase(std::remove_if(points.begin(), points.end(),
                              [](const Point& point) { return point.name == "reference"; }),
               points.end());
  for (const std::string name : report_scenes) {
    const bool wanted = only.empty() || std::any_of(only.begin(), only.end(), [&](const std::string& start) {
                          return name.rfind(start, 0) == 0;
                        });
    if (wanted) {
      const test::Scene scene = test::make_scene(name);
      const std::optional<Reference> reference = find_reference(scene, references);
      measure_in_turns(scene, points, reference ? &*reference : nullptr, in_turns, report);
    }
  }
  return report;
}

std::string format_gpu_report(const GpuReport& report) {
  const GpuCard* here = find_card(report.gpu);
  std::string text = "# Engines `cpu` and `gpu` side by side\n\n```\n" + report.machine;
  text += "engine    " + (report.gpu_problem.empty() ? report.gpu : report.gpu_problem) + "\n```\n\n";
  text +=
      "## Times and errors\n\nOne mean echo, the engines in turns: the median, and from where to where 80 % "
      "of "
      "the pings lie. RMS: root mean square of image / reference - 1.\n\n";
  text += times_table(report.results);
  if (!report.gpu_problem.empty()) {
    return text + "\nThere is no engine `gpu` here: no work is counted and nothing is predicted.\n";
  }
  text += "\n## Work of engine `gpu` a ping\n\n" + work_table(report.results);
  text += "\n## Predictions\n\n" + assumptions() + "\n";
  text += here != nullptr
              ? fmt::format("Engine `gpu` ran on the {}.\n", here->name)
              : "None of these cards runs here, so no prediction is compared with a measurement.\n";
  for (const GpuCard& card : gpu_cards()) {
    text += "\n" + prediction_table(report.results, card, &card == here);
  }
  return text;
}

}  // namespace sonard::bench
