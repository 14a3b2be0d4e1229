// SPDX-License-Identifier: Apache-2.0
// The interface between the pipeline and the engine that finds the echoes of the sonar's surroundings.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "renderer/ping.hpp"

namespace sonard::render {

struct PartMesh;  // renderer/scene/world.hpp

/// What a ping, or a span of its range, asks of an engine.
struct EchoRequest {
  Pose T_world_sonar;
  const SonarSettings& settings;
  /// What each line is yet to be multiplied with, for engines that weigh their errors; empty: 1.
  const std::vector<float>& line_weight;
  bool open_water = false;  ///< MeanEcho::open_sr is wanted; only in mode `physical`
};

/// The echo as it comes to the sonar, before array and pulse.
struct MeanEcho {
  /// Sum of response * solid angle * elevation pattern, steradians; in mode `paper` the weighted mean of the
  /// response. Spreading and absorption are left to the caller: they depend on the line alone, and taken per
  /// line they stay exact where one surface spreads over many lines.
  EchoImage image;
  /// [beam * lines + line], only where it was asked for. Solid angle * elevation pattern, steradians, of what
  /// of the beam nothing stands before, up to the middle of the line.
  std::vector<float> open_sr;
};

/// An echo that is asked for.
struct EchoJob {
  const EchoRequest& request;
  MeanEcho& echo;              ///< gets the result; what it holds is used as memory
  PingStatistics& statistics;  ///< gets what it took, added to what it holds
};

/// Finds what is visible and sums its echoes by beam and range line. One thread uses an engine.
///
/// To add an engine, implement this and make it in EngineSwitch. Every test of the image then runs on it.
class EchoEngine {
 public:
  EchoEngine() = default;
  virtual ~EchoEngine() = default;
  EchoEngine(const EchoEngine&) = delete;
  EchoEngine& operator=(const EchoEngine&) = delete;

  /// Renders the echoes of these requests; engines that wait for hardware have all of them in the making at
  /// once. Each depends on the world and its request alone, not on the others or on what came before.
  /// @throws RequestError when the settings of one cannot be sampled.
  /// @throws RendererError when the engine itself fails.
  virtual void images(std::span<const EchoJob> jobs) = 0;

  /// Renders one.
  void image(const EchoRequest& request, MeanEcho& echo, PingStatistics& statistics) {
    const EchoJob job{request, echo, statistics};
    images({&job, 1});
  }

  /// @param body in the order of the world, and in it.
  virtual void set_body_pose(std::size_t body, const Pose& T_world_body) = 0;

  /// Gives parts other meshes with the same attributes. Not for every ping: search trees of the mesh are
  /// rebuilt.
  /// @throws RendererError when the engine itself fails.
  virtual void set_part_meshes(std::span<const PartMesh> changes) = 0;

  /// From the next image on level rays sink by `bend_per_m` * x^2 over the horizontal distance x; 0, the
  /// default: they are straight. Only where RendererOptions::ray_curvature_per_m is not 0.
  virtual void set_refraction(double bend_per_m) = 0;

  /// The engine and what it runs on, for logs: "gpu, vendor / renderer / version".
  virtual const std::string& description() const = 0;
};

}  // namespace sonard::render
