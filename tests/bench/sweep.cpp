// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/bench/plans.hpp"
#include "tests/support/degree.hpp"

namespace sonard::bench {

namespace {

constexpr Repetition usual{5, 101, 0.5};
constexpr Repetition several{5, 201, 2.0};  // for ratios of two scenes

/// Presets, grids and points from coarse to fine, and the paper's.
Plan ladder() {
  Plan plan;
  for (const Point& point : preset_points()) {
    plan.points.push_back({point, usual});
  }
  for (const auto& [columns, rows] :
       {std::pair{1, 128}, {2, 128}, {2, 256}, {3, 512}, {4, 512}, {4, 1024}, {8, 1024}, {16, 2048}}) {
    plan.points.push_back({grid_point(columns, rows), usual});
  }
  for (const auto& [columns, rows] : {std::pair{2, 256}, {4, 512}, {8, 1024}, {16, 2048}}) {
    plan.points.push_back({point_binning(columns, rows), usual});
  }
  plan.points.push_back({paper_point(), usual});
  return plan;
}

Plan presets_only(unsigned threads = 0) {
  Plan plan;
  plan.threads = threads;
  for (const Point& point : preset_points()) {
    plan.points.push_back({point, usual});
  }
  return plan;
}

test::Scene renamed(test::Scene scene, const std::string& name) {
  scene.name = name;
  return scene;
}

class Sweep {
 public:
  Sweep(Campaign& campaign, const std::vector<std::string>& only) : campaign_(campaign), only_(only) {}

  /// Calls `make` only if the name is selected, because larger worlds take seconds.
  void run(const std::string& name, const Plan& plan, const std::function<test::Scene()>& make) {
    if (wanted(name)) {
      campaign_.run(make(), plan);
    }
  }

  void every_scene() {
    // `docking` comes first, because its mesh files are read in forked processes before other threads exist.
    run("docking", ladder(), [] { return test::make_scene("docking"); });
    for (const std::string& name : test::scene_names()) {
      if (name != "docking") {
        const bool large = name == "b4_manifold_1e7";
        run(name, large ? presets_only() : ladder(), [&] { return test::make_scene(name); });
      }
    }
  }

  void triangles() {
    for (const int exponent : {4, 5, 6, 7}) {
      const std::string name = fmt::format("swell@triangles=1e{}", exponent);
      run(name, presets_only(), [&] {
        const auto count = static_cast<std::size_t>(std::llround(std::pow(10.0, exponent)));
        return test::make_seabed_scene(name, test::swell_height_m, count);
      });
    }
  }

  void beams() {
    for (const int beams : {1, 128, 256, 512}) {
      const std::string name = fmt::format("swell100k@beams={}", beams);
      run(name, presets_only(), [&] {
        test::Scene scene = renamed(test::make_scene("swell100k"), name);
        const double width_rad = beams == 1 ? 3 * degree : 120 * degree;
        scene.settings.aperture.beam_edges_rad = render::equal_angle_edges(beams, width_rad);
        return scene;
      });
    }
  }

  void bins() {
    for (const int bins : {250, 500, 1000, 2000, 4000, 15000}) {
      const std::string name = fmt::format("swell100k@bins={}", bins);
      run(name, presets_only(), [&] {
        test::Scene scene = renamed(test::make_scene("swell100k"), name);
        scene.settings.range = {bins, scene.settings.range.max_range_m() / bins, 0, false};
        return scene;
      });
    }
  }

  void cores() {
    for (const unsigned cores : {1U, 2U}) {
      const std::string name = fmt::format("swell100k@cores={}", cores);
      run(name, presets_only(cores), [&] { return renamed(test::make_scene("swell100k"), name); });
    }
  }

  /// 200 bodies at rest, and the same bodies moving from ping to ping, for comparison.
  void bodies() {
    for (const bool drift : {false, true}) {
      const std::string name = drift ? "bodies200_moving" : "bodies200_still";
      Plan plan;
      plan.points.push_back({preset_points().front(), several});
      plan.points.push_back({default_point(), several, render::EngineKind::cpu});
      plan.points.push_back({grid_point(2, 256), several});
      plan.bodies_drift = drift;
      run(name, plan, [&] { return test::make_bodies_scene(name); });
    }
  }

  /// The same ground as heightmaps of different resolution.
  void terrain() {
    for (const int side_px : {256, 1024, 4096}) {
      const std::string name = fmt::format("terrain{}", side_px);
      Plan plan;
      plan.points.push_back({default_point(), several});
      plan.points.push_back({grid_point(2, 256), several});
      run(name, plan, [&] { return test::make_terrain_scene(name, side_px); });
    }
  }

 private:
  bool wanted(const std::string& name) const {
    return only_.empty() || std::any_of(only_.begin(), only_.end(),
                                        [&](const std::string& start) { return name.rfind(start, 0) == 0; });
  }

  Campaign& campaign_;
  const std::vector<std::string>& only_;
};

}  // namespace

void run_sweep(Campaign& campaign, const std::vector<std::string>& only) {
  Sweep sweep(campaign, only);
  sweep.every_scene();
  sweep.triangles();
  sweep.beams();
  sweep.bins();
  sweep.cores();
  sweep.bodies();
  sweep.terrain();
}

}  // namespace sonard::bench
