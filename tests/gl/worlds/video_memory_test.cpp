// SPDX-License-Identifier: Apache-2.0
// Video memory of the meshes and normal maps of a world, and its bound.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <osg/GLExtensions>

#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/engines/gpu/raster_sampler.hpp"
#include "tests/scenes/scenes.hpp"
#include "tests/scenes/shapes.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using namespace test;

constexpr std::uint64_t mib = 1 << 20;

class VideoMemoryOfWorlds : public ::testing::Test {
 protected:
  void SetUp() override { require_gl(); }

  static RendererOptions options(std::uint64_t memory_mib) {
    RendererOptions options{EngineKind::gpu, 0};
    options.gpu.memory_mib = memory_mib;
    return options;
  }
};

/// The total size of all buffers of a context, from OpenGL.
std::uint64_t buffer_bytes(EglContext& context) {
  const auto& gl = *context.getState()->get<osg::GLExtensions>();
  std::uint64_t bytes = 0;
  for (GLuint name = 1; name < 10'000; ++name) {
    if (gl.glIsBuffer(name) == GL_TRUE) {
      GLint size = 0;
      gl.glBindBuffer(GL_ARRAY_BUFFER, name);
      gl.glGetBufferParameteriv(GL_ARRAY_BUFFER, GL_BUFFER_SIZE, &size);
      bytes += static_cast<std::uint64_t>(size);
    }
  }
  gl.glBindBuffer(GL_ARRAY_BUFFER, 0);
  return bytes;
}

/// A square of 2 * cells^2 triangles in front of the sonar, with all attributes.
TriangleMesh make_square(unsigned cells) {
  TriangleMesh mesh;
  for (unsigned row = 0; row <= cells; ++row) {
    for (unsigned column = 0; column <= cells; ++column) {
      const glm::vec2 at(static_cast<float>(column) / static_cast<float>(cells),
                         static_cast<float>(row) / static_cast<float>(cells));
      mesh.positions.emplace_back(5.0F, 1 - 2 * at.x, 2 * at.y - 1);
      mesh.normals.emplace_back(-1, 0, 0);
      mesh.texcoords.push_back(at);
      mesh.tangents.emplace_back(0, -1, 0, 1);
    }
  }
  const unsigned side = cells + 1;
  for (unsigned row = 0; row < cells; ++row) {
    for (unsigned column = 0; column < cells; ++column) {
      const unsigned corner = row * side + column;
      mesh.indices.insert(mesh.indices.end(), {corner, corner + 1, corner + side + 1});
      mesh.indices.insert(mesh.indices.end(), {corner, corner + side + 1, corner + side});
    }
  }
  return mesh;
}

SampleGrid forward_grid(double width_rad) {
  Aperture aperture;
  aperture.beam_edges_rad = equal_angle_edges(8, width_rad);
  return make_sample_grid(aperture, Sampling::of_grid(1, 64, 64), {});
}

// 12 bytes a position and a normal, 8 a texture coordinate, 16 a tangent and the plane of a facet; 2 an
// index. Each triangle ends with its own vertex; some vertices end no triangle.
TEST_F(VideoMemoryOfWorlds, IsWhatOpenGlWasGiven) {
  constexpr unsigned cells = 30;  // one chunk
  constexpr std::uint64_t triangles = 2 * cells * cells;
  TriangleMesh mesh = make_square(cells);
  const osg::ref_ptr<EglContext> context = EglContext::made_current("");
  const auto expect_bytes = [&](std::uint64_t bytes_per_vertex) {
    World world = make_world({make_body("square", mesh)});
    RasterSampler sampler(*context, world, 100 * mib);
    const std::uint64_t before = buffer_bytes(*context);
    EXPECT_EQ(sampler.bytes(), 0U) << "nothing is drawn yet";
    sampler.sample({}, forward_grid(0.3), {}, 0, 20);
    const std::uint64_t bytes = sampler.bytes();
    EXPECT_GE(bytes, (bytes_per_vertex + 3 * 2) * triangles);
    EXPECT_LE(bytes, (1.01 * bytes_per_vertex + 3 * 2) * triangles);
    EXPECT_EQ(buffer_bytes(*context) - before, bytes);
    sampler.sample({}, forward_grid(0.3), {}, 0, 4);  // out of range: not needed, but there is room
    EXPECT_EQ(sampler.bytes(), bytes);
    world.bodies[0].parts[0].mesh = std::make_shared<const TriangleMesh>();
    sampler.sample({}, forward_grid(0.3), {}, 0, 20);
    EXPECT_EQ(sampler.bytes(), 0U);
    EXPECT_EQ(buffer_bytes(*context), before);
  };
  expect_bytes(12 + 16 + 12 + 8 + 16);
  mesh.tangents.clear();
  mesh.texcoords.clear();
  expect_bytes(12 + 16 + 12);
  mesh.normals.clear();
  expect_bytes(12 + 16);
}

// 8 bytes a texel of all levels, in rows of 4096.
TEST_F(VideoMemoryOfWorlds, HoldsNormalMapsToo) {
  const osg::ref_ptr<EglContext> context = EglContext::made_current("");
  World world = make_world({make_body("square", make_square(1))});
  world.bodies[0].parts[0].normal_map = std::make_shared<const NormalMap>(
      NormalMap{128, 128, std::vector<std::uint8_t>(std::size_t{3} * 128 * 128, 128)});
  RasterSampler sampler(*context, world, mib);
  sampler.sample({}, forward_grid(0.3), {}, 0, 20);
  constexpr std::uint64_t texels = 128 * 128 + 64 * 64 + 32 * 32 + 16 * 16 + 8 * 8 + 4 * 4 + 2 * 2 + 1;
  constexpr std::uint64_t rows = (texels + 4095) / 4096;
  EXPECT_EQ(sampler.bytes(), rows * 4096 * 8 + 4 * 64 + 6 * 2);
}

/// Renders each request with a bound and without.
class BoundedAndUnbounded {
 public:
  BoundedAndUnbounded(const World& world, const RendererOptions& bounded, std::uint64_t bound_bytes)
      : bounded_(world, bounded), bound_bytes_(bound_bytes) {
    RendererOptions options = bounded;
    options.gpu = {};
    unbounded_ = std::make_unique<SonarRenderer>(world, options);
  }

  void expect_same_image(const PingRequest& request) {
    const EchoImage image = bounded_.render_echo(request);
    const PingStatistics& statistics = bounded_.last_statistics();
    EXPECT_GT(statistics.gpu.video_memory_bytes, 0U);
    EXPECT_LE(statistics.gpu.video_memory_bytes, bound_bytes_);
    uploaded_bytes_ += statistics.gpu.bytes_uploaded;
    EXPECT_EQ(image.intensity, unbounded_->render_echo(request).intensity);
    EXPECT_GT(*std::max_element(image.intensity.begin(), image.intensity.end()), 0.0F);
    unbounded_bytes_ = std::max(unbounded_bytes_, unbounded_->last_statistics().gpu.video_memory_bytes);
  }

  std::uint64_t uploaded_bytes() const { return uploaded_bytes_; }
  std::uint64_t unbounded_bytes() const { return unbounded_bytes_; }

 private:
  SonarRenderer bounded_;
  std::unique_ptr<SonarRenderer> unbounded_;
  const std::uint64_t bound_bytes_;
  std::uint64_t uploaded_bytes_ = 0;
  std::uint64_t unbounded_bytes_ = 0;
};

/// A circle of balls around the origin, half of them with a normal map of their own.
World balls() {
  constexpr int count = 12;
  World world;
  for (int i = 0; i < count; ++i) {
    const double azimuth_rad = 2 * std::acos(-1.0) * i / count;
    Body ball = make_body("ball " + std::to_string(i), make_sphere(1, 64));  // 0.7 MiB
    ball.T_world_body.position_m = {6 * std::cos(azimuth_rad), 6 * std::sin(azimuth_rad), 0};
    if (i % 2 == 0) {
      TriangleMesh mesh = make_sphere(1, 64);
      mesh.texcoords.assign(mesh.positions.size(), {0, 0});
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        mesh.texcoords[v] = {mesh.positions[v].x, mesh.positions[v].z};
        mesh.tangents.emplace_back(1, 0, 0, 1);
      }
      ball.parts[0].mesh = std::make_shared<const TriangleMesh>(std::move(mesh));
      NormalMap map{64, 64, {}};
      for (int texel = 0; texel < 3 * 64 * 64; ++texel) {
        map.rgb.push_back(static_cast<std::uint8_t>(texel % 3 == 2 ? 230 : 128 + (texel * (7 + i)) % 50));
      }
      ball.parts[0].normal_map = std::make_shared<const NormalMap>(std::move(map));
    }
    world.bodies.push_back(std::move(ball));
  }
  return world;
}

// A sonar that turns sees two or three balls at a time.
TEST_F(VideoMemoryOfWorlds, OfBodiesStaysBoundedWithoutChangingAnImage) {
  BoundedAndUnbounded renderers(balls(), options(3), 3 * mib);
  PingRequest request;
  request.settings.aperture.beam_edges_rad = equal_angle_edges(32, 0.5);
  request.settings.aperture.vertical_beamwidth_rad = 0.35;
  request.settings.range = {400, 0.02, 0, false};
  for (int turn = 0; turn < 30; ++turn) {
    request.T_world_sonar = looking({0, 0, 0}, 25.0 * turn, 0);
    request.settings.sampling =
        turn % 2 == 0 ? Sampling::of_grid(2, 128, 128) : Sampling{Sampling::Preset::fast};
    renderers.expect_same_image(request);
  }
  EXPECT_GT(renderers.unbounded_bytes(), 9 * mib);
  EXPECT_GT(renderers.uploaded_bytes(), 15 * mib) << "what was released came back";
}

// The tiles of a terrain come and go by themselves, too.
TEST_F(VideoMemoryOfWorlds, OfATerrainStaysBoundedWithoutChangingAnImage) {
  Scene scene = make_terrain_scene("terrain", 1024);
  scene.settings.aperture.beam_edges_rad = equal_angle_edges(32, 0.5);
  scene.settings.sampling = Sampling::of_grid(1, 64, 64);
  for (const bool coarse : {false, true}) {
    const std::uint64_t bound_mib = coarse ? 3 : 16;
    RendererOptions bounded = options(bound_mib);
    if (!coarse) {
      bounded.skip.turn_off(SkipRule::terrain_detail);
    }
    BoundedAndUnbounded renderers(scene.world, bounded, bound_mib * mib);
    for (int step = 0; step < 10; ++step) {
      PingRequest request = scene.request();
      request.T_world_sonar =
          looking(scene.T_world_sonar.position_m + glm::dvec3(2.0 * step, 1.0 * step, 2), 36.0 * step, 15);
      renderers.expect_same_image(request);
    }
    std::printf("%g of %g MiB, %g uploaded\n", static_cast<double>(bound_mib),
                static_cast<double>(renderers.unbounded_bytes()) / mib,
                static_cast<double>(renderers.uploaded_bytes()) / mib);
    EXPECT_GT(renderers.unbounded_bytes(), 2 * bound_mib * mib);
  }
}

TEST_F(VideoMemoryOfWorlds, ThatDoNotFitAreLeftToTheCpuWithALineThatSaysWhy) {
  std::string what;
  RendererOptions bounded = options(1);
  bounded.report = [&](const std::string& line) { what = line; };
  const World world = make_world({make_body("ball", make_sphere(1, 200))});
  SonarRenderer renderer(world, bounded);
  PingRequest request;
  request.T_world_sonar = looking({-5, 0, 0}, 0, 0);
  request.settings.aperture.beam_edges_rad = equal_angle_edges(8, 1);
  request.settings.range = {100, 0.1, 0, false};
  request.settings.sampling = Sampling::of_grid(1, 64, 64);
  const std::vector<float> image = renderer.render_echo(request).intensity;
  EXPECT_THAT(what, ::testing::HasSubstr("gpu.memory_mib allows 1048576 (1 MiB)"));
  constexpr std::uint64_t triangles = 4 * 200 * 199;  // each with a vertex of its own, and some with two
  const std::uint64_t needed_bytes = std::stoull(what.substr(what.find("takes ") + 6));
  EXPECT_GE(needed_bytes, (6 + 40) * triangles);
  EXPECT_LT(needed_bytes, 1.05 * (6 + 40) * triangles);
  EXPECT_EQ(image, SonarRenderer(world, {EngineKind::cpu}).render_echo(request).intensity);
  EXPECT_EQ(renderer.engine(), EngineKind::gpu) << "of another ping it may see less";
  request.settings.range = {10, 0.1, 0, false};  // receives nothing of it
  EXPECT_NO_THROW(renderer.render_echo(request));
}

// 10 million triangles, of which a sonar that turns sees a tenth at a time.
TEST_F(VideoMemoryOfWorlds, OfTenMillionTrianglesStaysBounded) {
  const Scene scene = make_seabed_scene("swell", swell_height_m, 10'000'000);
  EXPECT_NEAR(static_cast<double>(scene.world.triangle_count()), 1e7, 1e4);
  constexpr std::uint64_t bound_mib = 64;
  SonarRenderer renderer(scene.world, options(bound_mib));
  PingRequest request = scene.request();
  request.settings.aperture.beam_edges_rad = equal_angle_edges(32, 0.8);
  request.settings.sampling = Sampling::of_grid(1, 128, 128);
  std::uint64_t uploaded_bytes = 0;
  std::vector<float> first;
  for (const double yaw_deg : {0.0, 60.0, 120.0, 180.0, 240.0, 300.0, 0.0}) {
    request.T_world_sonar = looking({14, 0, 4}, yaw_deg, 20);
    const EchoImage& image = renderer.render_echo(request);
    EXPECT_GT(*std::max_element(image.intensity.begin(), image.intensity.end()), 0.0F);
    const PingStatistics& statistics = renderer.last_statistics();
    EXPECT_LE(statistics.gpu.video_memory_bytes, bound_mib * mib);
    EXPECT_GT(statistics.gpu.bytes_uploaded, 0U);
    uploaded_bytes += statistics.gpu.bytes_uploaded;
    if (first.empty()) {
      first = image.intensity;
    } else if (yaw_deg == 0) {
      EXPECT_EQ(image.intensity, first) << "what was released came back as it was";
    }
  }
  EXPECT_GT(uploaded_bytes, 3 * bound_mib * mib);
}

}  // namespace
}  // namespace sonard::render
