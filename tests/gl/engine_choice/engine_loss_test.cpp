// SPDX-License-Identifier: Apache-2.0
// If the GPU fails in the middle of an image, the CPU renders this image and the next ones.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/pipeline/engine_trial.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "tests/gl/engine_choice/wall_and_ball.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::test {
namespace {

using render::EngineKind;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

class EngineLoss : public testing::Test {
 protected:
  void SetUp() override { require_gl(); }

  static render::PingRequest request(double x_m) {
    render::PingRequest request;
    request.settings.aperture.beam_edges_rad = render::equal_angle_edges(32, 1.0);
    request.settings.range = {500, 0.02, 0, false};
    request.T_world_sonar.position_m.x = x_m;
    return request;
  }
  render::RendererOptions losing_at(std::uint64_t image, double retry_s = 0.0) {
    render::RendererOptions options;
    options.engine = EngineKind::gpu;
    options.gpu.lose_context_at_image = image;
    options.gpu.retry_s = retry_s;
    options.report = [this](const std::string& line) { lines_.push_back(line); };
    return options;
  }

  std::vector<std::string> lines_;
};

TEST_F(EngineLoss, LosesNoPingAndSaysItOnce) {
  render::SonarRenderer losing(wall_and_ball(), losing_at(2));
  render::SonarRenderer cpu(wall_and_ball(), {EngineKind::cpu});
  render::SonarRenderer gpu(wall_and_ball(), {EngineKind::gpu});
  for (int ping = 0; ping < 4; ++ping) {
    // The world changes before the loss and after it.
    const render::Pose T_world_ball{{4.0 + 0.3 * ping, 0.2, 0.0}, {1, 0, 0, 0}};
    for (render::SonarRenderer* renderer : {&losing, &cpu, &gpu}) {
      ASSERT_TRUE(renderer->set_body_pose("ball", T_world_ball));
    }
    const std::vector<float>& got = losing.render_echo(request(0.1 * ping)).intensity;
    render::SonarRenderer& expected = ping == 0 ? gpu : cpu;
    EXPECT_EQ(got, expected.render_echo(request(0.1 * ping)).intensity) << "ping " << ping;
    EXPECT_EQ(losing.engine(), ping == 0 ? EngineKind::gpu : EngineKind::cpu);
    EXPECT_EQ(losing.last_statistics().samples, expected.last_statistics().samples);
  }
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("the GPU is lost: the OpenGL context is lost")));
  EXPECT_THAT(losing.engine_description(), StartsWith("cpu, "));
  EXPECT_THAT(losing.engine_description(), HasSubstr("the GPU is lost"));
}

TEST_F(EngineLoss, LosesNoPingOfAGrid) {
  render::SonarRenderer losing(wall_and_ball(), losing_at(2));
  render::SonarRenderer cpu(wall_and_ball(), {EngineKind::cpu});
  render::PingRequest grid = request(0);
  grid.settings.sampling = render::Sampling::of_grid(1, 64, 64);
  losing.render_echo(grid);
  EXPECT_EQ(losing.engine(), EngineKind::gpu);
  grid.T_world_sonar.position_m.x = 0.1;
  EXPECT_EQ(losing.render_echo(grid).intensity, cpu.render_echo(grid).intensity);
  EXPECT_EQ(losing.engine(), EngineKind::cpu);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("the GPU is lost: the OpenGL context is lost")));
}

TEST_F(EngineLoss, TheGpuComesBackWhereThatIsAskedFor) {
  render::SonarRenderer losing(wall_and_ball(), losing_at(2, 1e-9));
  std::vector<EngineKind> engines;
  for (int ping = 0; ping < 4; ++ping) {
    losing.render_echo(request(0.1 * ping));
    engines.push_back(losing.engine());
  }
  // The context made for the third image is also lost with its second image.
  EXPECT_THAT(engines, ElementsAre(EngineKind::gpu, EngineKind::cpu, EngineKind::gpu, EngineKind::cpu));
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("is lost"), HasSubstr("the GPU is back"), HasSubstr("is lost")));
}

TEST_F(EngineLoss, AGpuThatFailsAtOnceIsReportedWhereItIsAskedFor) {
  render::RendererOptions options = losing_at(1);
  options.gpu.device = "no such device";
  EXPECT_THROW(render::SonarRenderer(wall_and_ball(), options), render::RendererError);
}

class EngineTrials : public EngineLoss {};

TEST_F(EngineTrials, TakeTheFasterAndTellBothTimes) {
  render::SonarRenderer renderer(wall_and_ball(), {EngineKind::automatic});
  const std::vector<render::HeadRequest> pings{{0, request(0)}, {1, request(1)}};
  const render::EngineTrial trial = choose_engine(renderer, pings);
  EXPECT_GT(trial.cpu_ms, 0.0);
  EXPECT_GT(trial.gpu_ms, 0.0);
  EXPECT_EQ(renderer.engine(), trial.taken);
  EXPECT_THAT(trial.gpu_problem, testing::AnyOf("", "for only one beam in sixteen"));
  if (trial.gpu_problem.empty()) {
    EXPECT_EQ(trial.taken, trial.gpu_ms < trial.cpu_ms ? EngineKind::gpu : EngineKind::cpu);
  }
  EXPECT_THAT(describe(trial), testing::ContainsRegex("cpu takes [0-9.]+ ms per ping .*, gpu [0-9.]+ ms"));
  EXPECT_THAT(describe(trial), HasSubstr(std::string(name_of(trial.taken)) + " is taken"));
}

TEST_F(EngineTrials, AGpuThatIsLostOnTheWayIsNotTaken) {
  // At its first image, because the number of images in a trial depends on their duration.
  render::RendererOptions options = losing_at(1);
  options.engine = EngineKind::automatic;
  render::SonarRenderer renderer(wall_and_ball(), options);
  const std::vector<render::HeadRequest> pings{{0, request(0)}};
  const render::EngineTrial trial = choose_engine(renderer, pings);
  EXPECT_EQ(trial.taken, EngineKind::cpu);
  EXPECT_THAT(trial.gpu_problem, HasSubstr("the GPU is lost"));
  EXPECT_EQ(renderer.engine(), EngineKind::cpu);
}

TEST(EngineTrialsWithoutGl, SayWhatIsMissing) {
  render::RendererOptions options;
  options.gpu.device = "no such device";
  render::SonarRenderer renderer(render::World{}, options);
  render::PingRequest request;
  request.settings.aperture.beam_edges_rad = render::equal_angle_edges(4, 0.1);
  request.settings.range = {10, 0.1, 0, false};
  const std::vector<render::HeadRequest> pings{{0, request}};
  const render::EngineTrial trial = choose_engine(renderer, pings);
  EXPECT_EQ(trial.taken, EngineKind::cpu);
  EXPECT_EQ(trial.gpu, "");
  EXPECT_THAT(describe(trial), HasSubstr("gpu is not available: "));
}

}  // namespace
}  // namespace sonard::test
