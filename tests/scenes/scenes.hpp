// SPDX-License-Identifier: Apache-2.0
// The scenes that run time and error are measured on (docs/benchmark.md).
//
// Seabed scenes: a bed of 0.18 m facets and, but for `plane`, a box, a sphere, a pipeline and a pole on it;
// the sonar 4 m above z = 0, pitched 20 degrees down; 256 x 1000 bins over 120 x 20 degrees and 20 m. Meshes
// carry no normals, so facets are heard flat. B1 to B7 are those of docs/physics.md 3.5.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "renderer/ping.hpp"
#include "renderer/pose.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/sonar_settings.hpp"
#include "tests/scenes/bed.hpp"
#include "tests/support/closed_forms.hpp"

namespace sonard::test {

/// Lambert coefficient of every surface, that of a passive and fully diffuse one (1/pi); `docking` keeps its
/// own.
inline constexpr double scene_lambert_mu = 0.318309886183790672;

struct Scene {
  std::string name;
  render::World world;
  render::Pose T_world_sonar;
  render::SonarSettings settings;  ///< mode `physical`, no absorption, `top_hat`; sampling as by default
  /// Where all that is heard is one plane: the plane, in the sonar frame. Its echo is that of mu = 1.
  std::optional<PlaneTruth> plane;

  render::PingRequest request() const { return {T_world_sonar, settings, 0, 0}; }
};

/// Every name that make_scene() knows, cheap scenes first.
std::vector<std::string> scene_names();

/// Builds the scene of that name. `docking` reads mesh files in forked child processes: make it before there
/// are threads.
/// @throws std::invalid_argument for an unknown name; render::WorldError when `docking` cannot be read.
Scene make_scene(const std::string& name);

/// The seabed scene with objects over another bed, `triangles` in all (rounded to a square bed; at least
/// 7374).
Scene make_seabed_scene(const std::string& name, BedHeight height, std::size_t triangles);

/// 200 things on a flat bed, half of them boxes and half balls, each a body of its own, in all directions
/// that the fan looks: 97,202 triangles.
Scene make_bodies_scene(const std::string& name);

/// Where the bodies of make_bodies_scene() are at ping number `ping`: they drift by 5 to 20 mm and turn by a
/// degree a ping.
render::Pose drifting_pose(const render::Pose& start, std::size_t body, int ping);

/// A ground of 100 m by 100 m with relief of all lengths from 100 m to 0.1 m, as a heightmap of so many
/// pixels a side; the sonar is 6 m above it, looks 15 degrees down and hears 50 m in 1000 lines.
Scene make_terrain_scene(const std::string& name, int side_px);

/// B4: a manifold of about `triangles` (at least 5000) on a flat bed, 9 m ahead of the sonar.
Scene make_manifold_scene(const std::string& name, std::size_t triangles);

}  // namespace sonard::test
