// SPDX-License-Identifier: Apache-2.0
// Worlds and pings small enough for a test to render them to the last digit.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "renderer/scene/world.hpp"
#include "renderer/sonar_settings.hpp"
#include "tests/oracle/echo_truth.hpp"

namespace sonard::oracle {

/// `beams` of equal angle over `width_rad`; mode `physical`, top hat, no absorption.
inline render::SonarSettings ping(int beams, double width_rad, double height_rad, int lines, double range_m) {
  render::SonarSettings settings;
  for (int i = 0; i <= beams; ++i) {
    settings.aperture.beam_edges_rad.push_back(width_rad * (0.5 - static_cast<double>(i) / beams));
  }
  settings.aperture.vertical_beamwidth_rad = height_rad;
  settings.range = {lines, range_m / lines, 0, false};
  settings.physical.absorption_db_per_m = 0;
  return settings;
}

/// One body per mesh, at the world's origin, mu = rho = 1.
inline render::World world_of(std::vector<render::TriangleMesh> meshes) {
  render::World world;
  for (render::TriangleMesh& mesh : meshes) {
    render::BodyPart part;
    part.mesh = std::make_shared<const render::TriangleMesh>(std::move(mesh));
    part.material.lambert_mu = 1;
    part.material.reflectance = 1;
    world.bodies.push_back({"body" + std::to_string(world.bodies.size()), {}, {std::move(part)}});
  }
  return world;
}

/// A parallelogram: centre plus or minus the half sides.
inline render::TriangleMesh quad(const glm::dvec3& centre, const glm::dvec3& half_u,
                                 const glm::dvec3& half_v) {
  render::TriangleMesh mesh;
  for (const auto& [u, v] : {std::pair{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) {
    mesh.positions.emplace_back(centre + u * half_u + v * half_v);
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

/// Two triangles on the plane with this foot point, large enough for any fan. The body's pose, in double
/// precision, places them: corners in single precision would miss the plane by 1e-5 m.
inline render::World plane_world(const glm::dvec3& foot) {
  const glm::dvec3 normal = glm::normalize(foot);
  render::World world = world_of({quad({0, 0, 0}, {500, 0, 0}, {0, 500, 0})});
  const double turn = std::acos(normal.z);
  const glm::dvec3 across = glm::cross(glm::dvec3(0, 0, 1), normal);
  const glm::dvec3 axis = glm::length(across) > 0 ? glm::normalize(across) : glm::dvec3(1, 0, 0);
  world.bodies[0].T_world_body = {foot, glm::angleAxis(turn, axis)};
  return world;
}

/// Closed form: density(psi, r1, r2) integrated over each chosen beam; 0 in the other beams.
inline EchoTruth closed_form(const render::SonarSettings& settings, const std::vector<int>& beams,
                             const std::function<double(int beam, double r1, double r2)>& beam_echo) {
  EchoTruth truth;
  truth.beams = settings.aperture.beam_count();
  truth.lines = settings.range.count;
  truth.echo.assign(static_cast<std::size_t>(truth.beams) * static_cast<std::size_t>(truth.lines), 0.0);
  truth.error = truth.echo;
  for (const int beam : beams) {
    for (int k = 0; k < truth.lines; ++k) {
      const auto i = static_cast<std::size_t>(beam) * static_cast<std::size_t>(truth.lines) +
                     static_cast<std::size_t>(k);
      truth.echo[i] = beam_echo(beam, k * settings.range.step_m, (k + 1) * settings.range.step_m);
    }
  }
  return truth;
}

/// Sum of all lines of all beams.
inline double total(const EchoTruth& truth) {
  double sum = 0;
  for (const double value : truth.echo) {
    sum += value;
  }
  return sum;
}

}  // namespace sonard::oracle
