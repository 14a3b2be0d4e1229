// SPDX-License-Identifier: Apache-2.0
// Engine `gpu` as a whole: it makes the images of engine `cpu`, and waits once.
#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "tests/scenes/scenes.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

class GpuEngineTest : public ::testing::Test {
 protected:
  void SetUp() override { test::require_gl(); }
};

double rms_difference(const std::vector<float>& image, const std::vector<float>& truth) {
  double squares = 0, of_truth = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double off = static_cast<double>(image[i]) - static_cast<double>(truth[i]);
    squares += off * off;
    of_truth += static_cast<double>(truth[i]) * static_cast<double>(truth[i]);
  }
  return std::sqrt(squares / of_truth);
}

TEST_F(GpuEngineTest, MakesTheImagesOfTheCpu) {
  for (const char* name : {"plane", "b3_cluster", "b5_tank_smooth", "msis_ripple"}) {
    SCOPED_TRACE(name);
    const test::Scene scene = test::make_scene(name);
    SonarRenderer gpu(scene.world, {EngineKind::gpu});
    SonarRenderer cpu(scene.world, {EngineKind::cpu});
    const std::vector<float> of_gpu = gpu.render_echo(scene.request()).intensity;
    EXPECT_EQ(gpu.engine(), EngineKind::gpu);
    EXPECT_GT(gpu.last_statistics().gpu.passes, 0U) << "the CPU made it";
    EXPECT_LE(rms_difference(of_gpu, cpu.render_echo(scene.request()).intensity), 1e-3);
  }
}

// The first pings of a world may find their buffers too small.
TEST_F(GpuEngineTest, WaitsOnceAndReadsTheImage) {
  const test::Scene scene = test::make_scene("plane");
  SonarRenderer renderer(scene.world, {EngineKind::gpu});
  PingRequest request = scene.request();
  for (int ping = 0; ping < 3; ++ping) {
    request.T_world_sonar.position_m.x += ping < 2 ? 0.0 : 0.01;
    const std::vector<float> image = renderer.render_echo(request).intensity;
    const PingStatistics& statistics = renderer.last_statistics();
    if (ping == 2) {
      EXPECT_EQ(statistics.gpu.synchronisations, 1U);
      EXPECT_LE(statistics.gpu.bytes_read_back, image.size() * sizeof(float) + 65536);
      EXPECT_GT(statistics.gpu.bytes_read_back, image.size() * sizeof(float));
    }
  }
}

}  // namespace
}  // namespace sonard::render
