// SPDX-License-Identifier: Apache-2.0
// Scenes for measurements of run time and error (tests/bench/README.md).
//
// Seabed scenes: a bed of 0.18 m facets with a box, a sphere, a pipeline and a pole on it (`plane` has the
// bed only). The sonar is 4 m above z = 0, pitched 20 degrees down, with 256 x 1000 bins over 120 x 20
// degrees and 20 m. Meshes have no normals, so facets are flat. B1 to B7 are the scenes of docs/physics.md
// 3.5.
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

/// Lambert coefficient of all surfaces: of a passive and fully diffuse surface (1/pi). `docking` has its own
/// materials.
inline constexpr double scene_lambert_mu = 0.318309886183790672;

struct Scene {
  std::string name;
  render::World world;
  render::Pose T_world_sonar;
  render::SonarSettings settings;  ///< mode `physical`, no absorption, `top_hat`; default sampling
  /// Set if only one plane returns an echo: the plane in the sonar frame, with an echo for mu = 1.
  std::optional<PlaneTruth> plane;

  render::PingRequest request() const { return {T_world_sonar, settings, 0, 0}; }
};

/// The names of make_scene(), fast scenes first.
std::vector<std::string> scene_names();

/// Creates the scene with this name. `docking` reads mesh files in forked child processes: call it before
/// threads exist.
/// @throws std::invalid_argument for an unknown name; render::WorldError if `docking` cannot be read
Scene make_scene(const std::string& name);

/// The seabed scene with objects on another bed, with `triangles` in total (rounded to a square bed; at least
/// 7374).
Scene make_seabed_scene(const std::string& name, BedHeight height, std::size_t triangles);

/// 200 objects on a flat bed, half boxes and half balls, each a separate body, in all directions of the fan:
/// 97,202 triangles.
Scene make_bodies_scene(const std::string& name);

/// The pose of a body of make_bodies_scene() at ping number `ping`. Bodies drift by 5 to 20 mm and turn by a
/// degree per ping.
render::Pose drifting_pose(const render::Pose& start, std::size_t body, int ping);

/// A ground of 100 m by 100 m with relief of all lengths from 100 m to 0.1 m, as a heightmap of `side_px` by
/// `side_px` pixels. The sonar is 6 m above it, pitched 15 degrees down, with 1000 lines up to 50 m.
Scene make_terrain_scene(const std::string& name, int side_px);

/// B4: a manifold of about `triangles` (at least 5000) on a flat bed, 9 m ahead of the sonar.
Scene make_manifold_scene(const std::string& name, std::size_t triangles);

}  // namespace sonard::test
