// SPDX-License-Identifier: Apache-2.0
// One scene in one renderer, measured at points.
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

/// Gives a request the pose of timed ping `i`, always another one than before.
void move_to_timed_pose(render::PingRequest& request, const render::Pose& start, int i);

/// Adds how far an image is from the truth.
void add_errors(Measurements& results, const Subject& subject, const Point& point,
                const render::EchoImage& image, const Reference& reference);

/// Holds the renderer of a scene. Everything it finds is added to `results`, named after the scene, the
/// engine and the point. Timed pings stand a millimetre apart, so that none can reuse another; the error is
/// that of the scene's own pose.
class SceneRun {
 public:
  /// @param bodies_drift all bodies of the world but the first move before every timed ping, which is part of
  /// its time.
  /// @throws render::RendererError when the engine cannot be had.
  SceneRun(const test::Scene& scene, const render::RendererOptions& options, Measurements& results,
           bool bodies_drift = false);

  /// Times the mean echo (`ping_ms` and its stages, `unchanged_ms`), counts samples and memory, compares with
  /// the reference where there is one, and with itself (`repeatable`).
  void measure(const Point& point, const Reference* reference, const Repetition& repetition);

  /// Times the whole `physical` receiver on `lines` range bins as `metric`.
  /// @param change of the default settings
  void measure_receiver(const Point& point, int lines, const std::string& metric,
                        const Repetition& repetition,
                        const std::function<void(render::PhysicalModel&)>& change);

  /// Times what array and pulse add to an echo: `azimuth_pattern_ms`, `pulse_ms`, and what finding it costs
  /// in 1, 2 and 3 fine beams to a beam, as `sampling_fine_beams_N_ms`.
  void measure_reception(const Point& point, const Repetition& repetition);

  render::EngineKind engine() const { return renderer_.engine(); }
  const std::string& engine_description() const { return renderer_.engine_description(); }

 private:
  struct Stages {
    Timing ping_ms, visibility_ms, binning_ms, multipath_ms, cpu_part_ms;
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
