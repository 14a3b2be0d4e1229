// SPDX-License-Identifier: Apache-2.0
// Finds the body with the strongest echo in each bin, or each direction, of a ping.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "protocol/npy/npy_file.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::server {

/// Renders the mean echo of each body that is near enough, with all other bodies present but silent, and
/// compares them. Only the geometry of bins counts: beams have no side lobes, pulses no length, and there are
/// no mirror images. The sonar moves during the ping as in the request. Always uses the CPU. For one thread.
///
/// Needs a renderer for each body that was ever near, and the time of one echo for each body that is near.
class BodyTruth {
 public:
  BodyTruth(render::World world, const render::RendererOptions& options);

  /// Names of the bodies; the first has id 1.
  std::vector<std::string> bodies() const;

  void set_body_pose(const std::string& name, const render::Pose& T_world_body);

  /// For each sample of the ping, [line * beams + beam], the id of the body with most of its echo; 0 if no
  /// body echoes. For each direction of a ping with directions, [row * columns + column], the body with the
  /// strongest echo.
  /// @throws render::RequestError, render::RendererError
  std::vector<std::uint16_t> bodies_in(const render::PingRequest& request);

  /// `ids` as a table; of 8 bits if all ids of the world fit.
  npy::Table table(int rows, int columns, const std::vector<std::uint16_t>& ids) const;

 private:
  /// A sphere around a body, in the world frame.
  struct Ball {
    glm::dvec3 centre_m{0.0};
    double radius_m = 0.0;
  };
  static Ball ball_around(const render::Body& body);
  render::SonarRenderer& renderer_of(std::size_t body);

  render::World world_;
  render::RendererOptions options_;
  std::vector<Ball> balls_;
  std::map<std::size_t, std::unique_ptr<render::SonarRenderer>> renderers_;
};

}  // namespace sonard::server
