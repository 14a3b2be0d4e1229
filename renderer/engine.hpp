// SPDX-License-Identifier: Apache-2.0
// The interface between the pipeline and an engine, which finds the echoes of the sonar's surroundings.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "renderer/ping.hpp"

namespace sonard::render {

struct PartMesh;  // renderer/scene/world.hpp

/// The input of an engine for one ping, or for a span of its range.
struct EchoRequest {
  Pose T_world_sonar;
  const SonarSettings& settings;
  bool open_water = false;  ///< fill MeanEcho::open_sr; only in mode `physical`
  /// Factor per range bin; only if SonarSettings::directions is set, whose echoes have this loss.
  const std::vector<float>* loss_of_bin = nullptr;
};

/// The echo as it arrives at the sonar, before array and pulse.
struct MeanEcho {
  /// Sum of response * solid angle * elevation pattern, steradians. In mode `paper`: the weighted mean of the
  /// response. The caller applies spreading and absorption: they depend on the line alone, and applied per
  /// line they stay exact even if one surface spreads over many lines.
  EchoImage image;
  /// [beam * lines + line], only if requested. Solid angle * elevation pattern, steradians, of the part of
  /// the beam that nothing blocks up to the middle of the line.
  std::vector<float> open_sr;
  DirectionEchoes directions{};  ///< instead of the image, if SonarSettings::directions is set
};

/// One request, with the places for its results.
struct EchoJob {
  const EchoRequest& request;
  MeanEcho& echo;              ///< receives the result; its memory is reused
  PingStatistics& statistics;  ///< the cost is added to its values
};

/// Finds the visible surfaces and sums their echoes by beam and range line. One thread uses an engine.
///
/// To add an engine, implement this interface and construct it in EngineSwitch. Every image test then runs on
/// it.
class EchoEngine {
 public:
  EchoEngine() = default;
  virtual ~EchoEngine() = default;
  EchoEngine(const EchoEngine&) = delete;
  EchoEngine& operator=(const EchoEngine&) = delete;

  /// Renders the echoes of these requests. Engines that wait for hardware work on all of them at once. Each
  /// result depends only on the world and its request, not on other or earlier requests.
  /// @throws RequestError if the settings of a request cannot be sampled.
  /// @throws RendererError if the engine itself fails.
  virtual void images(std::span<const EchoJob> jobs) = 0;

  /// Renders one request.
  void image(const EchoRequest& request, MeanEcho& echo, PingStatistics& statistics) {
    const EchoJob job{request, echo, statistics};
    images({&job, 1});
  }

  /// @param body index of the body in the world; the pose is in the world frame.
  virtual void set_body_pose(std::size_t body, const Pose& T_world_body) = 0;

  /// Replaces the meshes of parts; their attributes stay. Too slow for every ping: it rebuilds the search
  /// trees of the meshes.
  /// @throws RendererError if the engine itself fails.
  virtual void set_part_meshes(std::span<const PartMesh> changes) = 0;

  /// From the next image on, level rays sink by `bend_per_m` * x^2 over the horizontal distance x; 0
  /// (default): rays are straight. Only if RendererOptions::ray_curvature_per_m is not 0.
  virtual void set_refraction(double bend_per_m) = 0;

  /// The engine and its hardware, for logs: "gpu, vendor / renderer / version".
  virtual const std::string& description() const = 0;
};

}  // namespace sonard::render
