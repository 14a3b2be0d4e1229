// SPDX-License-Identifier: Apache-2.0
#include "tests/scenes/scenes.hpp"

#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <utility>

#include "renderer/scene/terrain.hpp"
#include "tests/scenes/manifold.hpp"
#include "tests/scenes/shapes.hpp"
#include "tests/scenes/terrain.hpp"
#include "tests/support/degree.hpp"

namespace sonard::test {

namespace {

constexpr double sonar_height_m = 4.0;
constexpr double sonar_tilt_rad = 20 * degree;
constexpr std::size_t seabed_triangles = 106'830;
/// 40 x 40 m; contains the whole fan up to 21 m, including its edges.
constexpr BedExtent seabed_extent{-6, 34, -20, 20};
constexpr int seabed_cells = 223;  // of 0.18 m

// ---- bodies

render::Body make_body(std::string name, render::TriangleMesh mesh) {
  render::BodyPart part;
  part.mesh = std::make_shared<const render::TriangleMesh>(std::move(mesh));
  part.material.lambert_mu = scene_lambert_mu;
  return {std::move(name), {}, {std::move(part)}};
}

render::Body make_flat_bed(const BedExtent& extent) {
  return make_body("bed", make_bed(extent, 1, 1, flat_height_m));
}

/// A rectangle of 2 * half_width_m by 2 * half_height_m across the x axis.
render::Body make_wall(double x_m, double half_width_m, double half_height_m) {
  render::TriangleMesh mesh;
  for (const auto& [y, z] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    mesh.positions.emplace_back(glm::dvec3(x_m, y * half_width_m, z * half_height_m));
  }
  mesh.indices = {0, 2, 1, 0, 3, 2};  // front faces the origin
  return make_body("wall", std::move(mesh));
}

/// The objects on the seabed: 7372 triangles, the same in each scene. Each object is in other beams.
std::vector<render::Body> make_objects() {
  return {
      make_body("box", make_block({9.0, 5.2, 0.4}, {1.6, 1.0, 1.6}, 25 * degree)),
      make_body("sphere", make_ball({8.5, -1.8, 0.55}, 0.6, 64, 32)),
      make_body("pipeline", make_tube({6.5, -9.5, 0.2}, {14.0, -6.0, 0.2}, 0.25, 64, 19)),
      make_body("pole", make_tube({11.5, 1.6, -0.5}, {11.5, 1.6, 1.8}, 0.05, 32, 12)),
  };
}

std::size_t triangle_count(const std::vector<render::Body>& bodies) {
  render::World world;
  world.bodies = bodies;
  return world.triangle_count();
}

// ---- sonars

render::SonarSettings fan(int beams, double width_rad, double height_rad, int lines, double range_m) {
  render::SonarSettings settings;
  settings.aperture.beam_edges_rad = render::equal_angle_edges(beams, width_rad);
  settings.aperture.vertical_beamwidth_rad = height_rad;
  settings.range = {lines, range_m / lines, 0, false};
  settings.physical.absorption_db_per_m = 0;
  settings.physical.multipath.level = render::MultipathSettings::Level::off;  // as in the truth
  return settings;
}

render::SonarSettings forward_looking(int lines, double range_m) {
  return fan(256, 120 * degree, 20 * degree, lines, range_m);
}

/// A pose above (0, 0), turned to port by `yaw_rad`, then pitched down by `tilt_rad`.
render::Pose sonar_pose(double height_m, double yaw_rad, double tilt_rad) {
  render::Pose pose;
  pose.position_m.z = height_m;
  pose.orientation =
      glm::angleAxis(yaw_rad, glm::dvec3(0, 0, 1)) * glm::angleAxis(tilt_rad, glm::dvec3(0, 1, 0));
  return pose;
}

Scene make(const std::string& name, std::vector<render::Body> bodies, const render::Pose& T_world_sonar,
           const render::SonarSettings& settings) {
  Scene scene;
  scene.name = name;
  scene.world.name = name;
  scene.world.bodies = std::move(bodies);
  scene.T_world_sonar = T_world_sonar;
  scene.settings = settings;
  return scene;
}

// ---- scenes

PlaneTruth bed_below(double height_m, double tilt_rad, const render::SonarSettings& settings) {
  return {height_m, std::sin(tilt_rad), 0, -std::cos(tilt_rad), settings.aperture.elevation_limit_rad()};
}

Scene make_plane(const std::string& name) {
  Scene scene =
      make(name, {make_body("bed", make_bed(seabed_extent, seabed_cells, seabed_cells, flat_height_m))},
           sonar_pose(sonar_height_m, 0, sonar_tilt_rad), forward_looking(1000, 20));
  scene.plane = bed_below(sonar_height_m, sonar_tilt_rad, scene.settings);
  return scene;
}

/// One beam of a scanning sonar, turned towards the pipeline.
Scene make_scanning(const std::string& name, BedHeight height) {
  Scene scene = make_seabed_scene(name, height, seabed_triangles);
  scene.T_world_sonar = sonar_pose(sonar_height_m, -30 * degree, sonar_tilt_rad);
  scene.settings = fan(1, 3 * degree, 35 * degree, 500, 20);
  return scene;
}

Scene make_b1(const std::string& name) {
  Scene scene = make(name, {make_wall(10, 80, 40)}, {}, forward_looking(2600, 20.8));
  scene.plane = PlaneTruth{10, 1, 0, 0, scene.settings.aperture.elevation_limit_rad()};
  return scene;
}

Scene make_b2(const std::string& name, double height_m) {
  Scene scene = make(name, {make_flat_bed({-200, 200, -200, 200})}, sonar_pose(height_m, 0, 0),
                     forward_looking(1000, 50));
  scene.plane = bed_below(height_m, 0, scene.settings);
  return scene;
}

/// Spheres and vertical cylinders, some of them in each other's shadow.
Scene make_b3(const std::string& name) {
  std::vector<render::Body> bodies{make_flat_bed(seabed_extent)};
  const glm::dvec2 spheres[] = {{8.0, 0.0}, {9.5, 2.6}, {10.5, -3.5}, {13.0, 0.8}};
  const glm::dvec2 cylinders[] = {{8.2, -5.0}, {9.0, 4.5}, {12.0, -1.4}, {14.0, 4.0}};
  for (const glm::dvec2& at : spheres) {
    bodies.push_back(
        make_body("sphere" + std::to_string(bodies.size()), make_ball(glm::dvec3(at, 0.5), 0.5, 128, 64)));
  }
  for (const glm::dvec2& at : cylinders) {
    bodies.push_back(make_body("cylinder" + std::to_string(bodies.size()),
                               make_tube(glm::dvec3(at, 0), glm::dvec3(at, 1.2), 0.3, 128, 16)));
  }
  return make(name, std::move(bodies), sonar_pose(sonar_height_m, 0, sonar_tilt_rad),
              forward_looking(1000, 20));
}

/// A tank of 6 x 5 x 3 m without a water surface, with the sonar in one corner.
Scene make_b5(const std::string& name) {
  render::Pose T_world_sonar = sonar_pose(1.6, 35 * degree, 10 * degree);
  T_world_sonar.position_m += glm::dvec3(1.2, 1.1, 0);
  return make(name, {make_body("tank", make_block({3, 2.5, 1.5}, {6, 5, 3}, 0))}, T_world_sonar,
              forward_looking(1000, 8));
}

/// The tank with walls of smooth concrete and calm water, so that all its surfaces act as mirrors.
Scene make_b5_smooth(const std::string& name) {
  Scene scene = make_b5(name);
  render::AcousticMaterial& walls = scene.world.bodies[0].parts[0].material;
  walls.pressure_reflection = 0.68;
  walls.rms_height_m = 1e-4;
  scene.world.water_surface_z_m = 2.9;
  scene.settings.physical.multipath.level = render::MultipathSettings::Level::full;
  scene.settings.physical.multipath.water_surface_rms_height_m = 0;
  return scene;
}

/// Pipes with diameters of 2, 5, 10 and 20 cm at 5, 10, 20, 40 and 80 m. Each is upright (2 m, or less if the
/// fan is lower) and lying across its bearing (2 degrees wide). One every 3 degrees.
Scene make_b7(const std::string& name) {
  constexpr double spacing_rad = 3 * degree;
  std::vector<render::Body> bodies;
  for (const double range_m : {5.0, 10.0, 20.0, 40.0, 80.0}) {
    for (const double radius_m : {0.01, 0.025, 0.05, 0.10}) {
      const double upright_m = std::min(1.0, range_m * std::tan(8 * degree));
      const double across_m = range_m * std::tan(1 * degree);
      for (const bool upright : {true, false}) {
        const double bearing = (static_cast<double>(bodies.size()) - 19.5) * spacing_rad;
        const glm::dvec3 out(std::cos(bearing), std::sin(bearing), 0);
        const glm::dvec3 half =
            upright ? glm::dvec3(0, 0, upright_m) : across_m * glm::dvec3(-out.y, out.x, 0);
        bodies.push_back(make_body("pipe" + std::to_string(bodies.size()),
                                   make_tube(range_m * out - half, range_m * out + half, radius_m, 32, 8)));
      }
    }
  }
  return make(name, std::move(bodies), {}, forward_looking(1000, 85));
}

/// A copy of the docking station of configs/worlds, as the oracle rendered it. With the copy, the reference
/// and the figures of docs/accuracy.md and docs/benchmark.md stay comparable if the demo's world changes. The
/// sonar is at the first pose of configs/demo.yaml, a Gemini with a range of 20 m.
Scene make_docking(const std::string& name) {
  Scene scene;
  scene.name = name;
  scene.world = render::load_world(SONARD_SOURCE_DIR "/tests/data/scenes/docking/docking.sdf");
  scene.T_world_sonar = sonar_pose(-25.6, 80 * degree, sonar_tilt_rad);
  scene.T_world_sonar.position_m += glm::dvec3(-2.136, -11.913, 0);
  scene.settings =
      forward_looking(2411, 2411 * 1500.0 / 180844);  // range bins (protocol/gemini/README.md 6.5)
  scene.settings.aperture.beam_edges_rad = render::equal_sine_edges(256, 60 * degree);
  scene.settings.physical.backscatter = render::PhysicalModel::Backscatter::lambert;
  return scene;
}

/// The docking station with the elevation pattern of a Gemini, and facets, as in the demo.
Scene make_docking_demo(const std::string& name) {
  Scene scene = make_docking(name);
  scene.settings.aperture.elevation = render::Aperture::Elevation::sinc;
  scene.settings.physical.backscatter = render::PhysicalModel{}.backscatter;
  return scene;
}

using Maker = std::function<Scene(const std::string& name)>;

Maker seabed(BedHeight height, std::size_t triangles) {
  return [=](const std::string& name) { return make_seabed_scene(name, height, triangles); };
}

Maker scanning(BedHeight height) {
  return [=](const std::string& name) { return make_scanning(name, height); };
}

Maker b2(double height_m) {
  return [=](const std::string& name) { return make_b2(name, height_m); };
}

Maker b4(std::size_t triangles) {
  return [=](const std::string& name) { return make_manifold_scene(name, triangles); };
}

const std::vector<std::pair<std::string, Maker>>& makers() {
  static const std::vector<std::pair<std::string, Maker>> all{
      {"plane", make_plane},
      {"flat100k", seabed(flat_height_m, seabed_triangles)},
      {"swell100k", seabed(swell_height_m, seabed_triangles)},
      {"ripple100k", seabed(ripple_height_m, seabed_triangles)},
      {"msis_swell", scanning(swell_height_m)},
      {"msis_ripple", scanning(ripple_height_m)},
      {"b1_wall", make_b1},
      {"b2_seabed_2m", b2(2)},
      {"b2_seabed_5m", b2(5)},
      {"b2_seabed_10m", b2(10)},
      {"b3_cluster", make_b3},
      {"b5_tank", make_b5},
      {"b5_tank_smooth", make_b5_smooth},
      {"b6_water", [](const std::string& name) { return make(name, {}, {}, forward_looking(1000, 20)); }},
      {"b7_pipes", make_b7},
      {"docking", make_docking},
      {"docking_demo", make_docking_demo},
      {"b4_manifold_1e4", b4(10'000)},
      {"b4_manifold_1e5", b4(100'000)},
      {"swell1m", seabed(swell_height_m, 1'000'000)},
      {"b4_manifold_1e6", b4(1'000'000)},
      {"b4_manifold_1e7", b4(10'000'000)},
  };
  return all;
}

}  // namespace

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const auto& [name, maker] : makers()) {
    names.push_back(name);
  }
  return names;
}

Scene make_scene(const std::string& name) {
  for (const auto& [known, maker] : makers()) {
    if (known == name) {
      return maker(name);
    }
  }
  throw std::invalid_argument("no scene is called '" + name + "'");
}

Scene make_seabed_scene(const std::string& name, BedHeight height, std::size_t triangles) {
  std::vector<render::Body> bodies = make_objects();
  const double bed_triangles = static_cast<double>(triangles) - static_cast<double>(triangle_count(bodies));
  const int cells = std::max(1, static_cast<int>(std::lround(std::sqrt(std::max(2.0, bed_triangles) / 2))));
  bodies.insert(bodies.begin(), make_body("bed", make_bed(seabed_extent, cells, cells, height)));
  return make(name, std::move(bodies), sonar_pose(sonar_height_m, 0, sonar_tilt_rad),
              forward_looking(1000, 20));
}

Scene make_manifold_scene(const std::string& name, std::size_t triangles) {
  render::Body manifold = make_body("manifold", make_manifold(triangles));
  manifold.T_world_body.position_m = {12, 0, 0};
  manifold.T_world_body.orientation = glm::angleAxis(25 * degree, glm::dvec3(0, 0, 1));
  return make(name, {make_flat_bed(seabed_extent), std::move(manifold)},
              sonar_pose(sonar_height_m, 0, sonar_tilt_rad), forward_looking(1000, 20));
}

Scene make_bodies_scene(const std::string& name) {
  constexpr int rings = 10, per_ring = 20;
  std::vector<render::Body> bodies{make_flat_bed(seabed_extent)};
  const auto box = make_body("", make_block({}, {0.4, 0.3, 0.5}, 0)).parts;
  const auto ball = make_body("", make_ball({}, 0.25, 30, 17)).parts;
  for (int ring = 0; ring < rings; ++ring) {
    for (int k = 0; k < per_ring; ++k) {
      const double range_m = 7.0 + 1.2 * ring;
      const double bearing = (k + 0.5 * (ring % 2) - 9.75) * 5.8 * degree;
      render::Body body{"body" + std::to_string(bodies.size()), {}, k % 2 == 0 ? box : ball};
      body.T_world_body.position_m = {range_m * std::cos(bearing), range_m * std::sin(bearing), 0.5};
      bodies.push_back(std::move(body));
    }
  }
  return make(name, std::move(bodies), sonar_pose(sonar_height_m, 0, sonar_tilt_rad),
              forward_looking(1000, 20));
}

render::Pose drifting_pose(const render::Pose& start, std::size_t body, int ping) {
  const double step_m = 0.005 * static_cast<double>(1 + body % 4);
  const double heading = static_cast<double>(body);
  constexpr int turning_point = 20;  // in pings: bodies move to and fro
  const int steps =
      std::abs((ping + turning_point) % (4 * turning_point) - 2 * turning_point) - turning_point;
  return {start.position_m + step_m * steps * glm::dvec3(std::cos(heading), std::sin(heading), 0),
          start.orientation * glm::angleAxis(steps * degree, glm::dvec3(0, 0, 1))};
}

Scene make_terrain_scene(const std::string& name, int side_px) {
  render::BodyPart part;
  part.material.lambert_mu = scene_lambert_mu;
  Scene scene = make(name, {{"bed", {}, {}}}, sonar_pose(6 + ground_height_m(0, 0), 0, 15 * degree),
                     forward_looking(1000, 50));
  render::add_heightmap(ground_picture(side_px), {ground_side_m, ground_side_m, ground_relief_m}, part,
                        scene.world, 0, scene.world.bodies[0].parts);
  return scene;
}

}  // namespace sonard::test
