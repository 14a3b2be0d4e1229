// SPDX-License-Identifier: Apache-2.0
// Measures a series of scenes on all available engines.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "renderer/physical_model.hpp"
#include "renderer/renderer_options.hpp"
#include "tests/bench/measurements.hpp"
#include "tests/bench/points.hpp"
#include "tests/bench/timing.hpp"
#include "tests/scenes/scenes.hpp"

namespace sonard::bench {

struct Reference;

struct PlannedPoint {
  Point point;
  Repetition repetition;
  std::optional<render::EngineKind> only = std::nullopt;  ///< set if all engines give the same result
};

/// The complete receiver, timed at the default preset.
struct PlannedReceiver {
  int lines;
  std::string metric;
  Repetition repetition;
  std::function<void(render::PhysicalModel&)> change = [](render::PhysicalModel&) {};  ///< of defaults
};

/// The measurements of one scene.
struct Plan {
  std::vector<PlannedPoint> points;
  std::vector<PlannedReceiver> receivers;
  std::optional<Repetition> reception = std::nullopt;  ///< array and pulse, at preset `fast`
  bool bodies_drift = false;                           ///< all bodies except the first move before each ping
  unsigned threads = 0;                                ///< as in render::RendererOptions
};

class Campaign {
 public:
  Campaign(std::vector<render::EngineKind> engines, std::filesystem::path references);

  /// Measures `scene` on each engine, each in its own renderer. Prints a line of progress for each point to
  /// stderr, and why a point or an engine was left out.
  void run(const test::Scene& scene, const Plan& plan);

  const Measurements& results() const { return results_; }
  /// The hardware of each engine that measured something, by the engine's name.
  const std::map<std::string, std::string>& descriptions() const { return descriptions_; }

 private:
  void run_in_renderer(render::EngineKind engine, const test::Scene& scene, const Plan& plan,
                       const Reference* reference);

  std::vector<render::EngineKind> engines_;
  std::filesystem::path references_;
  std::map<std::string, std::string> descriptions_;
  Measurements results_;
};

}  // namespace sonard::bench
