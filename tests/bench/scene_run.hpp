// SPDX-License-Identifier: Apache-2.0
// Measures one scene in one renderer at several points.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "tests/bench/measurements.hpp"
#include "tests/bench/points.hpp"
#include "tests/bench/reference.hpp"
#include "tests/bench/timing.hpp"
#include "tests/scenes/scenes.hpp"

namespace sonard::bench {

/// Sets the pose of timed ping `i`, which differs from the previous one.
void move_to_timed_pose(render::PingRequest& request, const render::Pose& start, int i);

/// Adds the errors of an image.
void add_errors(Measurements& results, const Subject& subject, const Point& point,
                const render::EchoImage& image, const Reference& reference);

/// Holds the renderer of a scene. Adds all results to `results`, named after scene, engine and point. Timed
/// pings are a millimetre apart, so that no ping can reuse another. Errors are for the scene's own pose.
class SceneRun {
 public:
  /// @param bodies_drift if true, all bodies except the first move before each timed ping, within its time
  /// @throws render::RendererError if the engine is not available
  SceneRun(const test::Scene& scene, const render::RendererOptions& options, Measurements& results,
           bool bodies_drift = false);

  /// Times the mean echo (`ping_ms` and its stages, `unchanged_ms`), counts samples and memory, and compares
  /// the image with the reference (if there is one) and with a second image (`repeatable`).
  void measure(const Point& point, const Reference* reference, const Repetition& repetition);

  /// Times the whole `physical` receiver on `lines` range bins as `metric`.
  /// @param change applied to the default settings
  void measure_receiver(const Point& point, int lines, const std::string& metric,
                        const Repetition& repetition,
                        const std::function<void(render::PhysicalModel&)>& change);

  /// Times array and pulse: `azimuth_pattern_ms`, `pulse_ms`, and for 1, 2 and 3 fine beams per beam the
  /// sampling (`sampling_fine_beams_N_ms`) and the pattern (`pattern_fine_beams_N_ms`).
  void measure_reception(const Point& point, const Repetition& repetition);

  render::EngineKind engine() const { return renderer_.engine(); }
  const std::string& engine_description() const { return renderer_.engine_description(); }

 private:
  struct Stages {
    Timing ping_ms, visibility_ms, binning_ms, multipath_ms;
  };

  Subject subject(const Point& point) const;
  render::PingRequest request(const Point& point) const;
  void drift(int ping);
  Stages time_pings(render::PingRequest request, const Repetition& repetition);
  Timing time_unchanged(const render::PingRequest& request, const Repetition& repetition);
  void add_times(const Subject& subject, const Stages& stages, const Timing& unchanged_ms);

  const test::Scene& scene_;
  Measurements& results_;
  render::SonarRenderer renderer_;
  bool bodies_drift_;
};

}  // namespace sonard::bench
