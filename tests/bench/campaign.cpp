// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/campaign.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cstdio>
#include <utility>

#include "renderer/errors.hpp"
#include "tests/bench/reference.hpp"
#include "tests/bench/scene_run.hpp"

namespace sonard::bench {

namespace {

void report(const Measurements& results, const Subject& subject) {
  const auto text = [&](const char* metric, double scale, const char* unit) {
    const auto value = results.find(subject, metric);
    return value ? fmt::format("{:.3g} {}", scale * *value, unit) : std::string("-");
  };
  fmt::print(stderr, "{:<28} {:<7} {:<16} {:>12} {:>12}\n", subject.scene, subject.engine, subject.preset,
             text("ping_ms", 1, "ms"), text("bin_rms", 100, "%"));
}

void note(const std::string& what, const std::exception& reason) {
  fmt::print(stderr, "left out: {}: {}\n", what, reason.what());
}

}  // namespace

Campaign::Campaign(std::vector<render::EngineKind> engines, std::filesystem::path references)
    : engines_(std::move(engines)), references_(std::move(references)) {}

void Campaign::run(const test::Scene& scene, const Plan& plan) {
  const std::optional<Reference> reference = find_reference(scene, references_);
  for (const render::EngineKind engine : std::vector(engines_)) {
    run_in_renderer(engine, scene, plan, reference ? &*reference : nullptr);
  }
}

void Campaign::run_in_renderer(render::EngineKind engine, const test::Scene& scene, const Plan& plan,
                               const Reference* reference) {
  const std::string name(render::name_of(engine));
  std::optional<SceneRun> run;
  try {
    run.emplace(scene, render::RendererOptions{engine, plan.threads, {}}, results_, plan.bodies_drift);
  } catch (const render::RendererError& error) {
    note(name, error);
    engines_.erase(std::remove(engines_.begin(), engines_.end(), engine), engines_.end());
    return;
  }
  descriptions_[name] = run->engine_description();
  for (const auto& [point, repetition, only] : plan.points) {
    if (only.value_or(engine) != engine) {
      continue;
    }
    try {
      run->measure(point, reference, repetition);
      report(results_, {scene.name, name, point.name});
    } catch (const render::RequestError& error) {
      note(fmt::format("{} {} {}", scene.name, name, point.name), error);
    }
  }
  if (plan.reception) {
    run->measure_reception(preset_points().front(), *plan.reception);
  }
  for (const PlannedReceiver& receiver : plan.receivers) {
    run->measure_receiver(default_point(), receiver.lines, receiver.metric, receiver.repetition,
                          receiver.change);
  }
}

}  // namespace sonard::bench
