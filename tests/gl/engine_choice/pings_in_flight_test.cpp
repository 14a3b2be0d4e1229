// SPDX-License-Identifier: Apache-2.0
// Pings of several heads in flight on the GPU at once equal the pings that each head gets alone.
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "tests/gl/engine_choice/wall_and_ball.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::test {
namespace {

using render::EngineKind;
using render::HeadRequest;

class PingsInFlight : public testing::Test {
 protected:
  void SetUp() override { require_gl(); }

  static render::RendererOptions options(std::uint64_t lose_at = 0) {
    render::RendererOptions options;
    options.engine = EngineKind::gpu;
    options.gpu.lose_context_at_image = lose_at;
    return options;
  }

  /// Heads with different settings, more than may be in flight at once.
  static std::vector<HeadRequest> pings() {
    std::vector<HeadRequest> pings;
    for (int head = 0; head < 11; ++head) {
      HeadRequest ping;
      ping.head = head;
      ping.request.seed = 7;
      ping.request.T_world_sonar.position_m.y = 0.1 * head;
      render::SonarSettings& settings = ping.request.settings;
      settings.aperture.beam_edges_rad = render::equal_angle_edges(16 + head, 1.0);
      settings.range = {400 + head, 0.03, 0, false};
      pings.push_back(ping);
    }
    pings[1].request.settings.model = render::Model::paper;
    pings[2].request.settings.sampling = render::Sampling::of_grid(2, 64, 64);
    pings[3].request.settings.physical.volume_scattering_db = -60.0;
    pings[4].request.settings.transmit = false;
    pings[5].request.settings.aperture.azimuth = render::Aperture::Azimuth::array;
    pings[6].request.T_world_sonar_at_end = looking({0, 1, 0}, 20, 0);
    pings[7].request.settings.sampling.preset = render::Sampling::Preset::fast;
    return pings;
  }

  static std::vector<float> alone(const HeadRequest& ping, EngineKind engine = EngineKind::gpu) {
    render::SonarRenderer renderer(wall_and_ball(), {engine});
    return renderer.render_echo(ping.request, ping.head).intensity;
  }
};

TEST_F(PingsInFlight, AreThoseOfEachHeadAlone) {
  render::SonarRenderer renderer(wall_and_ball(), options());
  const std::vector<HeadRequest> all = pings();
  renderer.begin_pings(all);
  for (const HeadRequest& ping : all) {
    EXPECT_EQ(renderer.render_echo(ping.request, ping.head).intensity, alone(ping)) << ping.head;
    const render::PingStatistics& statistics = renderer.last_statistics();
    if (ping.head != 4 && ping.head != 6) {
      EXPECT_GE(statistics.gpu.passes, 1U) << ping.head;
      EXPECT_LE(statistics.gpu.synchronisations, statistics.gpu.passes + 1) << ping.head;
      EXPECT_GT(statistics.samples, 0U) << ping.head;
    }
  }
}

TEST_F(PingsInFlight, AreMadeAgainWhenTheWorldHasMovedOn) {
  render::SonarRenderer renderer(wall_and_ball(), options());
  render::SonarRenderer other(wall_and_ball(), options());
  const std::vector<HeadRequest> all = pings();
  renderer.begin_pings(all);
  for (render::SonarRenderer* one : {&renderer, &other}) {
    ASSERT_TRUE(one->set_body_pose("ball", {{4, 0, 0}, {1, 0, 0, 0}}));
  }
  EXPECT_EQ(renderer.render_echo(all[0].request, 0).intensity,
            other.render_echo(all[0].request, 0).intensity);
}

TEST_F(PingsInFlight, AreThoseThatAreAskedForInTheEnd) {
  render::SonarRenderer renderer(wall_and_ball(), options());
  std::vector<HeadRequest> all = pings();
  renderer.begin_pings(all);
  all[0].request.T_world_sonar.position_m.x = 1;
  EXPECT_EQ(renderer.render_echo(all[0].request, 0).intensity, alone(all[0]));
}

TEST_F(PingsInFlight, ComeFromTheCpuWhenTheGpuIsLostOnTheWay) {
  render::SonarRenderer renderer(wall_and_ball(), options(3));
  const std::vector<HeadRequest> all = pings();
  renderer.begin_pings(all);
  EXPECT_EQ(renderer.engine(), EngineKind::cpu);
  for (const HeadRequest& ping : all) {
    EXPECT_EQ(renderer.render_echo(ping.request, ping.head).intensity, alone(ping, EngineKind::cpu))
        << ping.head;
  }
}

// The first faces the wall, the second a ball larger than the allowed video memory.
TEST_F(PingsInFlight, StayTheGpusBesideOneThatItCannotHold) {
  const render::World large = make_world({wall_ahead(), make_body("ball", make_sphere(1, 200))});
  render::RendererOptions bounded = options();
  bounded.gpu.memory_mib = 1;
  std::vector<HeadRequest> two{pings()[0], pings()[8]};
  for (HeadRequest& ping : two) {
    ping.request.T_world_sonar = looking({3, 0, 0}, ping.head == 0 ? 0 : 180, 0);
  }
  render::SonarRenderer renderer(large, bounded);
  renderer.begin_pings(two);
  for (const HeadRequest& ping : two) {
    render::SonarRenderer alone(large, {ping.head == 0 ? EngineKind::gpu : EngineKind::cpu});
    EXPECT_EQ(renderer.render_echo(ping.request, ping.head).intensity,
              alone.render_echo(ping.request, ping.head).intensity)
        << ping.head;
    EXPECT_EQ(renderer.last_statistics().gpu.passes > 0, ping.head == 0) << ping.head;
  }
  EXPECT_EQ(renderer.engine(), EngineKind::gpu);
}

TEST_F(PingsInFlight, OneThatCannotBeMadeIsToldWhenItIsItsTurn) {
  render::SonarRenderer renderer(wall_and_ball(), options());
  std::vector<HeadRequest> all = pings();
  all[0].request.settings.range.count = 0;
  renderer.begin_pings(all);
  EXPECT_THROW(renderer.render_echo(all[0].request, 0), render::RequestError);
  EXPECT_EQ(renderer.render_echo(all[1].request, 1).intensity, alone(all[1]));
}

}  // namespace
}  // namespace sonard::test
