// SPDX-License-Identifier: Apache-2.0
// Rasterised and traced images agree bin by bin (docs/physics.md 4.3, S21). Samples within 1/512 of a pixel
// of an edge may differ: GL moves vertices to a raster of 1/256 pixel, so such a sample can see the other
// side of the edge.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "tests/scenes/scenes.hpp"
#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using test::looking;
using test::make_body;
using test::make_quad;
using test::make_sphere;
using test::make_world;

/// A world and the sonar's pose in it.
struct View {
  World world;
  Pose T_world_sonar;
};

View shipped_world(const std::string& file, const Pose& T_world_sonar) {
  return {load_world(std::string(SONARD_SOURCE_DIR) + "/configs/worlds/" + file, {}), T_world_sonar};
}

/// A basin of 9 x 6 x 3 m seen from inside, a ball with vertex normals and a box in it.
View tank() {
  World world = make_world({make_body("floor", make_quad({-1, -3, 0}, {9, 0, 0}, {0, 6, 0}), 0.01),
                            make_body("end", make_quad({8, -3, 0}, {0, 6, 0}, {0, 0, 3}), 0.05),
                            make_body("port", make_quad({-1, 3, 0}, {9, 0, 0}, {0, 0, 3}), 0.05),
                            make_body("starboard", make_quad({-1, -3, 0}, {9, 0, 0}, {0, 0, 3}), 0.05),
                            make_body("ball", make_sphere(0.4F, 48), 0.1),
                            make_body("box", make_quad({0, 0, 0}, {0.3F, 0.5F, 0}, {0, 0, 0.8F}), 0.02)});
  world.bodies[4].T_world_body.position_m = {4, 1, 1.2};
  world.bodies[5].T_world_body.position_m = {5, -1.5, 0};
  return {std::move(world), looking({0, 0, 1.6}, 5, 8)};
}

/// A wavy bed with a normal map of odd size, repeated often, so that averaging and repetition matter.
View normal_mapped_bed() {
  constexpr int cells = 60;
  TriangleMesh bed;
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      const float x = -15.0F + 0.5F * static_cast<float>(i);
      const float y = -15.0F + 0.5F * static_cast<float>(j);
      bed.positions.emplace_back(x, y, 0.2F * std::sin(0.8F * x) * std::cos(0.6F * y));
      bed.normals.push_back(glm::normalize(glm::vec3(-0.16F * std::cos(0.8F * x) * std::cos(0.6F * y),
                                                     0.12F * std::sin(0.8F * x) * std::sin(0.6F * y), 1.0F)));
      bed.tangents.emplace_back(glm::normalize(glm::cross(glm::vec3(0, 1, 0), bed.normals.back())), 1.0F);
      bed.texcoords.emplace_back(0.7F * x, 0.7F * y);
    }
  }
  for (std::uint32_t j = 0; j < cells; ++j) {
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t a = j * (cells + 1) + i;
      bed.indices.insert(bed.indices.end(), {a, a + 1, a + cells + 2, a, a + cells + 2, a + cells + 1});
    }
  }
  auto map = std::make_shared<NormalMap>();
  map->width_px = 77;
  map->height_px = 50;
  for (int j = 0; j < map->height_px; ++j) {
    for (int i = 0; i < map->width_px; ++i) {
      const double slope_x = 0.5 * std::sin(2 * std::numbers::pi * 7 * i / map->width_px);
      const double slope_y = 0.4 * std::cos(2 * std::numbers::pi * 3 * j / map->height_px);
      const glm::dvec3 n = glm::normalize(glm::dvec3(slope_x, slope_y, 1));
      for (const double component : {n.x, n.y, n.z}) {
        map->rgb.push_back(static_cast<std::uint8_t>(std::lround((component + 1) * 127.5)));
      }
    }
  }
  World world = make_world({make_body("bed", std::move(bed), 0.02)});
  world.bodies[0].parts[0].normal_map = map;
  return {std::move(world), looking({-8, 0, 4}, 0, 25)};
}

/// 256 beams, 20 m; neither speckle nor noise.
PingRequest quiet_request(const Pose& T_world_sonar) {
  PingRequest request;
  request.settings.sampling = Sampling::of_grid(3, 256, 512);
  request.T_world_sonar = T_world_sonar;
  SonarSettings& settings = request.settings;
  settings.aperture.beam_edges_rad = equal_sine_edges(256, 60 * degree);
  settings.range = {1000, 0.02, 0, false};
  settings.physical.speckle.kind = SpeckleSettings::Kind::off;
  settings.physical.noise.on = false;
  settings.paper.speckle = PaperModel::Speckle::off;
  return request;
}

struct Difference {
  std::size_t bins = 0;
  std::size_t echoes = 0;     ///< bins with an echo
  std::size_t different = 0;  ///< by more than 1e-3 of the beam's strongest bin
  std::size_t off_by_2 = 0;   ///< eight-bit samples that differ by more than one
};

Difference difference(SonarRenderer& gpu, SonarRenderer& cpu, const PingRequest& request) {
  const EchoImage a = gpu.render_echo(request);
  const EchoImage b = cpu.render_echo(request);
  Difference result;
  result.bins = a.intensity.size();
  for (int beam = 0; beam < a.beams; ++beam) {
    float strongest = 0;
    for (int k = 0; k < a.bins; ++k) {
      strongest = std::max(strongest, a.at(beam, k));
    }
    for (int k = 0; k < a.bins; ++k) {
      result.echoes += a.at(beam, k) > 0 ? 1 : 0;
      result.different += std::abs(a.at(beam, k) - b.at(beam, k)) > 1e-3F * strongest ? 1 : 0;
    }
  }
  const PingSamples sent_a = gpu.render_ping(request);
  const PingSamples sent_b = cpu.render_ping(request);
  for (std::size_t i = 0; i < sent_a.u8.size(); ++i) {
    result.off_by_2 += std::abs(int{sent_a.u8[i]} - int{sent_b.u8[i]}) > 1 ? 1 : 0;
  }
  return result;
}

void expect_agreement(const Difference& d, const std::string& name) {
  std::printf("%s: %zu of %zu bins hold echoes, %zu differ by over 1e-3, %zu by over 1 of 255\n",
              name.c_str(), d.echoes, d.bins, d.different, d.off_by_2);
  EXPECT_GT(d.echoes, d.bins / 20) << name;
  EXPECT_LE(static_cast<double>(d.different), 1e-3 * static_cast<double>(d.bins)) << name;
  EXPECT_LE(static_cast<double>(d.off_by_2), 1e-3 * static_cast<double>(d.bins)) << name;
}

class EngineAgreement : public ::testing::Test {
 protected:
  void SetUp() override { test::require_gl(); }

  static void expect_agreement_of(const View& view, const std::string& name, const PingRequest& request) {
    SonarRenderer gpu(view.world, {EngineKind::gpu, 0});
    SonarRenderer cpu(view.world, {EngineKind::cpu, 0});
    expect_agreement(difference(gpu, cpu, request), name);
  }
  static void expect_agreement_of(const View& view, const std::string& name) {
    expect_agreement_of(view, name, quiet_request(view.T_world_sonar));
  }
};

TEST_F(EngineAgreement, S21DockingStation) {
  expect_agreement_of(shipped_world("docking_station.sdf", looking({-2.136, -11.913, -25.6}, 80, 20)),
                      "docking station");
}

TEST_F(EngineAgreement, S21IsolationValveWithNormalMap) {
  expect_agreement_of(shipped_world("ssiv.sdf", looking({4.617, -12.686, -37.7}, 110, 20)),
                      "isolation valve");
}

TEST_F(EngineAgreement, S21Tank) {
  expect_agreement_of(tank(), "tank");
}

TEST_F(EngineAgreement, S21NormalMapAveragedOverSamples) {
  expect_agreement_of(normal_mapped_bed(), "normal map");
}

TEST_F(EngineAgreement, S21OddNumbersOfColumnsAndRows) {
  const View view = tank();
  PingRequest request = quiet_request(view.T_world_sonar);
  request.settings.sampling = Sampling::of_grid(3, 251, 301);
  expect_agreement_of(view, "odd grid", request);
}

TEST_F(EngineAgreement, S21ModePaperWithBackFacesDropped) {
  View view = tank();
  PingRequest request = quiet_request(view.T_world_sonar);
  request.settings.model = Model::paper;
  request.settings.paper.sigmoid_slope = 5;  // steep ones leave few bins above 0
  request.settings.paper.attenuation_per_m = 0.024;
  expect_agreement_of(view, "paper", request);
  request.settings.paper.two_sided = false;
  expect_agreement_of(view, "paper, front faces", request);
}

TEST_F(EngineAgreement, S21MovedBodies) {
  const View view = tank();
  SonarRenderer gpu(view.world, {EngineKind::gpu, 0});
  SonarRenderer cpu(view.world, {EngineKind::cpu, 0});
  const PingRequest request = quiet_request(view.T_world_sonar);
  for (const double step : {0.0, 0.7, 1.4}) {
    const Pose moved{{4 + step, 1 - step, 1}, glm::angleAxis(step, glm::normalize(glm::dvec3(1, 2, 3)))};
    for (SonarRenderer* renderer : {&gpu, &cpu}) {
      ASSERT_TRUE(renderer->set_body_pose("ball", moved));
      ASSERT_TRUE(renderer->set_body_pose("box", looking({5 - step, -1.5, 0.1}, 40 * step, 10)));
    }
    expect_agreement(difference(gpu, cpu, request), "moved by " + std::to_string(step));
  }
}

TEST_F(EngineAgreement, S21FarFromTheOriginAndRotated) {
  const Pose T_far_world{{1e6, -1e6, 3e5}, glm::angleAxis(0.7, glm::normalize(glm::dvec3(0.2, 0.3, 1)))};
  View view = tank();
  for (Body& body : view.world.bodies) {
    body.T_world_body = T_far_world * body.T_world_body;
  }
  view.T_world_sonar = T_far_world * view.T_world_sonar;
  expect_agreement_of(view, "far away");
}

/// First line of a beam with an echo, or the number of lines.
int first_echo(const EchoImage& image, int beam) {
  int k = 0;
  while (k < image.bins && !(image.at(beam, k) > 0)) {
    ++k;
  }
  return k;
}

// A smooth tube's silhouette is a facet seen edge-on, over which the range changes by more than itself.
// OpenGL draws it in pixels of which it fills little.
TEST_F(EngineAgreement, S21NothingEchoesBeforeTheNearestSurface) {
  const test::Scene scene = test::make_scene("docking");
  SonarRenderer gpu(scene.world, {EngineKind::gpu, 0});
  SonarRenderer cpu(scene.world, {EngineKind::cpu, 0});
  for (const auto& [yaw, pitch] : {std::pair{0, 15}, {0, 30}, {60, 15}, {100, 30}, {135, 10}, {165, 15}}) {
    PingRequest request = quiet_request(looking(scene.T_world_sonar.position_m, yaw, pitch));
    request.settings.sampling = Sampling::of_grid(3, 512, 512);
    const EchoImage drawn = gpu.render_echo(request);
    const EchoImage traced = cpu.render_echo(request);
    const float largest = *std::ranges::max_element(traced.intensity);
    for (int beam = 0; beam < drawn.beams; ++beam) {
      for (int k = 0; k < first_echo(traced, beam) - 2; ++k) {
        ASSERT_LT(drawn.at(beam, k), 1e-6F * largest) << "beam " << beam << " at yaw " << yaw;
      }
    }
  }
}

// An explicit choice of engine is kept, and each engine describes itself.
TEST_F(EngineAgreement, EnginesNameThemselves) {
  const SonarRenderer gpu(World{}, {EngineKind::gpu, 0});
  EXPECT_EQ(gpu.engine(), EngineKind::gpu);
  EXPECT_EQ(gpu.engine_description().rfind("gpu, ", 0), 0U) << gpu.engine_description();
  const SonarRenderer cpu(World{}, {EngineKind::cpu, 0});
  EXPECT_EQ(cpu.engine(), EngineKind::cpu);
  EXPECT_EQ(cpu.engine_description().rfind("cpu, Embree ", 0), 0U) << cpu.engine_description();
}

}  // namespace
}  // namespace sonard::render
