// SPDX-License-Identifier: Apache-2.0
// A series of scenes measured on every backend there is.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "renderer/backend.hpp"
#include "renderer/sonar_settings.hpp"
#include "tests/bench/measurements.hpp"
#include "tests/bench/points.hpp"
#include "tests/bench/timing.hpp"
#include "tests/scenes/scenes.hpp"

namespace sonard::bench {

struct Reference;

struct PlannedPoint {
  Point point;
  Repetition repetition;
  std::optional<render::Backend> only = std::nullopt;  ///< where any backend gives the same answer
};

/// The whole receiver, timed at the default preset.
struct PlannedReceiver {
  int lines;
  std::string metric;
  Repetition repetition;
  std::function<void(render::PhysicalModel&)> change = [](render::PhysicalModel&) {};  ///< of the default
};

/// What to measure in one scene.
struct Plan {
  std::vector<PlannedPoint> points;
  std::vector<PlannedReceiver> receivers;
  std::optional<Repetition> reception = std::nullopt;  ///< of array and pulse, at preset `fast`
  bool bodies_drift = false;                           ///< all bodies but the first, every ping
  unsigned threads = 0;                                ///< as render::RendererOptions
};

class Campaign {
 public:
  Campaign(std::vector<render::Backend> backends, std::filesystem::path references);

  /// Measures `scene` on each backend, each in a renderer of its own. A line of progress for each point goes
  /// to stderr, as does why a point or a backend was left out.
  void run(const test::Scene& scene, const Plan& plan);

  const Measurements& results() const { return results_; }
  /// What each backend ran on, by its name; only backends that measured something.
  const std::map<std::string, std::string>& descriptions() const { return descriptions_; }

 private:
  void run_in_renderer(render::Backend backend, const test::Scene& scene, const Plan& plan,
                       const Reference* reference);

  std::vector<render::Backend> backends_;
  std::filesystem::path references_;
  std::map<std::string, std::string> descriptions_;
  Measurements results_;
};

}  // namespace sonard::bench
