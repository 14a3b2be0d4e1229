// SPDX-License-Identifier: Apache-2.0
#include <numbers>
#include <utility>

#include "tests/bench/plans.hpp"

namespace sonard::bench {

namespace {

constexpr Repetition some{7, 201, 0.2};
constexpr Repetition many{50, 1000, 0.3};  // for pings of some ten microseconds
constexpr Repetition few{2, 3, 0.3};

/// `reference` is slow, so only one scene measures it. `gpu` is measured if a ping takes less than a second.
Plan presets(const std::string& scene, const Repetition& repetition) {
  Plan plan;
  for (const Point& point : preset_points()) {
    const bool reference = point.name == "reference";
    if (reference && scene != "flat100k") {
      continue;
    }
    plan.points.push_back({point, reference ? few : repetition, render::EngineKind::cpu});
    const bool slow = point.name != "fast" && (scene == "ripple100k" || scene == "swell1m");
    if (!slow) {
      plan.points.push_back({point, few, render::EngineKind::gpu});
    }
  }
  return plan;
}

/// Adds point binning with increasing numbers of samples.
void add_point_ladder(Plan& plan) {
  for (const auto& [columns, rows] : {std::pair{4, 512}, {8, 1024}, {16, 2048}}) {
    plan.points.push_back({point_binning(columns, rows), few, render::EngineKind::cpu});
  }
}

/// The receiver at ranges of 8, 20 and 50 m, and at 8 m with one effect less or one more.
std::vector<PlannedReceiver> receivers() {
  using render::PhysicalModel;
  using render::PulseSettings;
  using render::SpeckleSettings;
  return {
      {1000, "receiver_ms", many},
      {2411, "receiver_2411_ms", many},
      {6028, "receiver_6028_ms", some},
      {1000, "receiver_without_noise_ms", many, [](PhysicalModel& model) { model.noise.on = false; }},
      {1000, "receiver_without_speckle_ms", many,
       [](PhysicalModel& model) { model.speckle.kind = SpeckleSettings::Kind::off; }},
      {1000, "receiver_frozen_ms", many,
       [](PhysicalModel& model) { model.speckle.kind = SpeckleSettings::Kind::frozen; }},
      {1000, "receiver_with_texture_ms", many, [](PhysicalModel& model) { model.speckle.texture_nu = 1; }},
      {1000, "receiver_with_range_correlation_ms", many,
       [](PhysicalModel& model) {
         model.pulse.shape = PulseSettings::Shape::tone;
         model.pulse.range_cell_m = 0.025;  // three lines
       }},
      {1000, "receiver_with_interference_ms", many,
       [](PhysicalModel& model) { model.noise.interference.probability = 1; }},
      {1000, "receiver_with_ring_down_ms", many, [](PhysicalModel& model) { model.ring_down.on = true; }}};
}

/// The settings of configs/demo-oculus.yaml: 512 beams over 130 degrees, 20 m in 1165 rows.
test::Scene with_512_beams(test::Scene scene) {
  scene.name += "@beams=512";
  scene.settings.aperture.beam_edges_rad = render::equal_sine_edges(512, 65 * std::numbers::pi / 180);
  scene.settings.range = {1165, 0.01716, 0, false};
  return scene;
}

}  // namespace

void run_quick(Campaign& campaign) {
  for (const char* name : {"plane", "flat100k", "swell100k", "ripple100k", "swell1m"}) {
    const test::Scene scene = test::make_scene(name);
    Plan plan = presets(name, some);
    if (scene.name == "plane") {
      plan.receivers = receivers();
    }
    if (scene.name == "swell100k") {
      plan.reception = some;
    }
    if (scene.name == "flat100k") {
      plan.points.push_back({paper_point(), some});
    }
    if (scene.name != "ripple100k" && scene.name != "swell1m") {
      add_point_ladder(plan);
    }
    campaign.run(scene, plan);
  }
  Plan demo;  // the world and first pose of the demo; a ping of `gpu` takes seconds
  for (const Point& point : preset_points()) {
    if (point.name != "reference") {
      demo.points.push_back({point, some, render::EngineKind::cpu});
    }
  }
  campaign.run(test::make_scene("docking"), demo);
  campaign.run(with_512_beams(test::make_scene("docking")), demo);
  for (const char* name : {"msis_swell", "msis_ripple"}) {
    campaign.run(test::make_scene(name), presets(name, many));
  }
}

}  // namespace sonard::bench
