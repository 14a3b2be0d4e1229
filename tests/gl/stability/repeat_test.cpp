// SPDX-License-Identifier: Apache-2.0
// S12, S18 and S21 of docs/physics.md 4.3: the same image every time, after every change, on every engine.
#include <atomic>
#include <thread>

#include "tests/gl/stability/stability_test.hpp"

namespace sonard::render {
namespace {

using namespace test;

SONARD_STABILITY_SUITE(Repeat);

/// quiet_request() with everything random on.
PingRequest lively(PingRequest request) {
  request.settings.physical.speckle.kind = SpeckleSettings::Kind::per_ping;
  request.settings.physical.noise.on = true;
  return request;
}

/// Threads that keep all cores busy, so that workers are preempted and take other shares of the work.
class Load {
 public:
  Load() {
    for (unsigned i = 0; i < std::max(2U, std::thread::hardware_concurrency()); ++i) {
      threads_.emplace_back([this] {
        while (!stop_) {
          for (int k = 0; k < 1000; ++k) {
            spins_.fetch_add(1, std::memory_order_relaxed);
          }
          std::this_thread::yield();
        }
      });
    }
  }
  ~Load() {
    stop_ = true;
    for (std::thread& thread : threads_) {
      thread.join();
    }
  }
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;

 private:
  std::atomic<bool> stop_{false};
  std::atomic<long> spins_{0};
  std::vector<std::thread> threads_;
};

TEST_P(Repeat, S12SameInputGivesTheSameBitsAHundredTimesUnderLoadAndWithAnyThreads) {
  const PingRequest request = lively(quiet_request());
  RendererOptions every_time = options();
  every_time.skip.turn_off(SkipRule::unchanged_scene);  // or the echo would be made once
  SonarRenderer renderer(small_harbour(), every_time);
  const EchoImage echo = renderer.render_echo(request);
  const PingSamples samples = renderer.render_ping(request);
  EXPECT_GT(sum(echo), 0);
  for (int i = 0; i < 50; ++i) {
    ASSERT_EQ(renderer.render_echo(request).intensity, echo.intensity) << i;
    ASSERT_EQ(renderer.render_ping(request).u8, samples.u8) << i;
  }
  const Load load;
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(renderer.render_ping(request).u8, samples.u8) << "under load, " << i;
  }
  for (const unsigned threads : {1U, 2U, 3U, 7U}) {
    SonarRenderer other(small_harbour(), options(threads));
    for (int i = 0; i < 8; ++i) {
      ASSERT_EQ(other.render_echo(request).intensity, echo.intensity) << threads << " threads";
      ASSERT_EQ(other.render_ping(request).u8, samples.u8) << threads << " threads";
    }
  }
}

// Bodies move, leave the world (far away) and return. Apertures, ranges and samplings change from ping to
// ping, and two sonars take turns. Every image equals the image of a fresh renderer.
TEST_P(Repeat, S18EveryPingAfterAChangeIsThatOfAFreshRenderer) {
  SonarRenderer renderer(small_harbour(), options());
  const auto fresh = [](const Pose& ball, const Pose& crate, const PingRequest& request) {
    World world = small_harbour();
    world.bodies[1].T_world_body = ball;
    world.bodies[2].T_world_body = crate;
    return SonarRenderer(world, options()).render_echo(request).intensity;
  };
  Pose ball = small_harbour().bodies[1].T_world_body;
  Pose crate = small_harbour().bodies[2].T_world_body;
  for (int step = 0; step < 12; ++step) {
    PingRequest request = quiet_request();
    if (step % 3 == 1) {
      ball = {{7, 0.2 * step, 0.4}, glm::angleAxis(0.3 * step, glm::dvec3(1, 0, 0))};
    }
    if (step % 4 == 2) {
      crate.position_m = {1e6, 0, -1e6};
    } else if (step % 4 == 3) {
      crate = {{5, -1, 0}, glm::angleAxis(0.1 * step, glm::dvec3(0, 0, 1))};
    }
    if (step % 2 == 1) {
      request.settings.aperture.beam_edges_rad = equal_angle_edges(16 + step, 90 * degree);
      request.settings.sampling.columns_per_view = 64 + 16 * step;
      request.settings.sampling.rows = 200 - 8 * step;
    }
    if (step % 5 == 4) {
      request.settings.range = {300, 0.05, 0, false};
      request.T_world_sonar.position_m.x = 0.5;
    }
    ASSERT_TRUE(renderer.set_body_pose("ball", ball));
    ASSERT_TRUE(renderer.set_body_pose("crate", crate));
    ASSERT_EQ(renderer.render_echo(request).intensity, fresh(ball, crate, request)) << "step " << step;
    PingRequest other = request;  // the second sonar of the same renderer
    other.T_world_sonar.position_m.y = 1;
    ASSERT_EQ(renderer.render_echo(other).intensity, fresh(ball, crate, other)) << "step " << step;
  }
}

// The long form, scene by scene, is tests/gl/renderer/engine_agreement_test.cpp.
TEST(Agreement, S21EnginesAgreeOnOneGrid) {
  require_gl();
  if (testing::Test::IsSkipped() || testing::Test::HasFatalFailure()) {
    return;
  }
  PingRequest request;
  request.settings.aperture.beam_edges_rad = equal_sine_edges(128, 60 * degree);
  request.settings.range = {800, 0.02, 0, false};
  request.settings.sampling = Sampling::of_grid(3, 256, 256);
  request.settings.physical.speckle.kind = SpeckleSettings::Kind::off;
  request.settings.physical.noise.on = false;
  request.T_world_sonar = {{0, 0, 3}, glm::angleAxis(20 * degree, glm::dvec3(0, 1, 0))};
  SonarRenderer gpu(small_harbour(), {EngineKind::gpu, 0});
  SonarRenderer cpu(small_harbour(), {EngineKind::cpu, 0});
  const EchoImage a = gpu.render_echo(request);
  const EchoImage b = cpu.render_echo(request);
  EXPECT_GT(sum(a), 0);
  EXPECT_LE(different_share(a, b, 1e-3), silhouette_share);
  const PingSamples sent_a = gpu.render_ping(request);
  const PingSamples sent_b = cpu.render_ping(request);
  std::size_t different = 0;
  for (std::size_t i = 0; i < sent_a.u8.size(); ++i) {
    different += std::abs(int{sent_a.u8[i]} - int{sent_b.u8[i]}) > 1 ? 1 : 0;
  }
  EXPECT_LE(static_cast<double>(different), silhouette_share * static_cast<double>(sent_a.u8.size()));
}

}  // namespace
}  // namespace sonard::render
