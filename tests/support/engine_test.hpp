// SPDX-License-Identifier: Apache-2.0
// Fixture for tests of images, which run on each engine. Without OpenGL, tests of `gpu` are skipped with a
// reason; with SONARD_REQUIRE_GL set, as in CI, they fail, so that coverage is not lost silently. Tests of
// `cpu` always run.
#pragma once

#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "renderer/pipeline/sonar_renderer.hpp"

namespace sonard::test {

/// Why engine `gpu` cannot run here; empty if it can.
inline const std::string& gl_problem() {
  static const std::string problem = [] {
    try {
      const render::SonarRenderer renderer(render::World{}, {render::EngineKind::gpu, 0});
      std::printf("%s\n", renderer.engine_description().c_str());
      return std::string();
    } catch (const render::RendererError& error) {
      return std::string(error.what());
    }
  }();
  return problem;
}

/// Call it first in a test, or in a fixture's SetUp(), that needs OpenGL.
inline void require_gl() {
  if (gl_problem().empty()) {
    return;
  }
  if (std::getenv("SONARD_REQUIRE_GL") != nullptr) {
    FAIL() << gl_problem();
  }
  GTEST_SKIP() << gl_problem();
}

class EngineTest : public ::testing::TestWithParam<render::EngineKind> {
 protected:
  void SetUp() override {
    if (GetParam() == render::EngineKind::gpu) {
      require_gl();
    }
  }

  /// Options for SonarRenderer.
  static render::RendererOptions options() { return {GetParam(), 0}; }
};

inline auto all_engines() {
  return ::testing::Values(render::EngineKind::gpu, render::EngineKind::cpu);
}

inline std::string engine_name(const ::testing::TestParamInfo<render::EngineKind>& info) {
  return std::string(render::name_of(info.param));
}

/// A sonar turned to port about the vertical, then tilted down.
inline render::Pose looking(const glm::dvec3& position_m, double yaw_deg, double down_deg) {
  return {position_m, glm::angleAxis(glm::radians(yaw_deg), glm::dvec3(0, 0, 1)) *
                          glm::angleAxis(glm::radians(down_deg), glm::dvec3(0, 1, 0))};
}

/// A body with one mesh, at the world's origin.
inline render::Body make_body(const std::string& name, render::TriangleMesh mesh, double lambert_mu = 1.0) {
  render::BodyPart part;
  part.mesh = std::make_shared<const render::TriangleMesh>(std::move(mesh));
  part.material.lambert_mu = lambert_mu;
  return {name, {}, {part}};
}

inline render::World make_world(std::vector<render::Body> bodies) {
  render::World world;
  world.bodies = std::move(bodies);
  return world;
}

/// A parallelogram: corner, corner + a, corner + a + b, corner + b.
inline render::TriangleMesh make_quad(const glm::vec3& corner, const glm::vec3& a, const glm::vec3& b) {
  render::TriangleMesh mesh;
  mesh.positions = {corner, corner + a, corner + a + b, corner + b};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

/// A sphere of n by 2n facets with exact vertex normals.
inline render::TriangleMesh make_sphere(float radius_m, int n) {
  render::TriangleMesh mesh;
  const auto pi = static_cast<float>(std::acos(-1.0));
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= 2 * n; ++j) {
      const float polar = pi * static_cast<float>(i) / static_cast<float>(n);
      const float azimuth = pi * static_cast<float>(j) / static_cast<float>(n);
      const glm::vec3 normal(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                             std::cos(polar));
      mesh.positions.push_back(radius_m * normal);
      mesh.normals.push_back(normal);
    }
  }
  const auto index = [&](int i, int j) { return static_cast<std::uint32_t>(i * (2 * n + 1) + j); };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      if (i > 0) {
        mesh.indices.insert(mesh.indices.end(), {index(i, j), index(i + 1, j), index(i, j + 1)});
      }
      if (i + 1 < n) {
        mesh.indices.insert(mesh.indices.end(), {index(i, j + 1), index(i + 1, j), index(i + 1, j + 1)});
      }
    }
  }
  return mesh;
}

}  // namespace sonard::test
