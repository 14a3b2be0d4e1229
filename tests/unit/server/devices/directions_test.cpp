// SPDX-License-Identifier: Apache-2.0
// A job with directions, on its way through the render thread and back to the device.
#include "server/devices/directions.hpp"

#include <cmath>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "server/rendering/world_renderer.hpp"
#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"
#include "tests/support/wait_for.hpp"

namespace sonard::server {
namespace {

PingJob wall_job() {
  PingJob job;
  job.number = 7;
  job.native_bins = 1000;
  job.native_bin_m = 0.01;
  job.directions = {.columns = 40,
                    .rows = 12,
                    .horizontal_fov_rad = 60 * degree,
                    .vertical_fov_rad = 30 * degree,
                    .nearest_m = 0.5};
  return job;
}

/// Renders a job from the origin in a world with a wall ahead at x = 6 m, as Head does.
RenderResult render(const PingJob& job) {
  const render::World world =
      test::make_world({test::make_body("wall", test::make_quad({6, -40, -40}, {0, 80, 0}, {0, 0, 80}))});
  std::mutex mutex;
  std::deque<std::function<void()>> posted;
  RenderServiceHooks hooks;
  hooks.post = [&](std::function<void()> task) {
    const std::lock_guard lock(mutex);
    posted.push_back(std::move(task));
  };
  render::RendererOptions options;
  options.engine = render::EngineKind::cpu;
  RenderService service(world_renderer_factory(world, options, {}), 1, hooks);
  PosedPing ping;
  ping.request.ping_number = job.number;
  set_directions(job, 2 * degree, 3 * degree, ping.request.settings);
  std::optional<RenderResult> result;
  service.submit(std::move(ping), [&](RenderResult made) { result = std::move(made); });
  test::wait_for([&] {
    const std::lock_guard lock(mutex);
    return !posted.empty();
  });
  service.stop();
  for (const auto& task : posted) {
    task();
  }
  return result.value_or(RenderResult{.samples = {}, .error = "no answer", .statistics = {}});
}

TEST(Directions, DeviceGetsTheRangesOfThePlane) {
  const PingJob job = wall_job();
  RenderResult result = render(job);
  ASSERT_EQ(result.error, "");
  const PingImage image = image_of(job.number, std::move(result.samples), std::nullopt);
  EXPECT_EQ(image.number, 7U);
  EXPECT_TRUE(image.u8.empty() && image.u16.empty());
  const DirectionRanges& seen = image.directions;
  ASSERT_EQ(seen.columns, 40);
  ASSERT_EQ(seen.rows, 12);
  ASSERT_EQ(seen.range_m.size(), job.directions.count());
  ASSERT_EQ(seen.intensity.size(), job.directions.count());
  for (int row = 0; row < 12; ++row) {
    for (int column = 0; column < 40; ++column) {
      const double yaw = (column / 39.0 - 0.5) * 60 * degree, pitch = (row / 11.0 - 0.5) * 30 * degree;
      const auto pixel = static_cast<std::size_t>(row * 40 + column);
      EXPECT_NEAR(static_cast<double>(seen.range_m[pixel]), 6 / (std::cos(yaw) * std::cos(pitch)), 0.05)
          << "column " << column << ", row " << row;
      EXPECT_GT(seen.intensity[pixel], 0.0F);
    }
  }
}

TEST(Directions, EchoesBeyondTheRangeOrNearerThanTheNearestAreNone) {
  PingJob job = wall_job();
  job.native_bins = 500;
  for (const float range_m : image_of(0, render(job).samples, std::nullopt).directions.range_m) {
    EXPECT_EQ(range_m, 0.0F);
  }
  job = wall_job();
  job.directions.nearest_m = 9.0;
  for (const float range_m : image_of(0, render(job).samples, std::nullopt).directions.range_m) {
    EXPECT_EQ(range_m, 0.0F);
  }
}

TEST(Directions, ImpossibleOnesFailThePing) {
  PingJob job = wall_job();
  job.directions.rows = 1;
  EXPECT_EQ(render(job).error.rfind("directions: 40 x 1", 0), 0U) << render(job).error;
}

TEST(Directions, ImagesOfBinsHaveNone) {
  render::PingSamples samples;
  samples.u8 = {1, 2, 3};
  const PingImage image = image_of(3, samples, SensorReadings{1.0, 0.0, 0.0, std::nullopt});
  EXPECT_EQ(image.u8, samples.u8);
  EXPECT_EQ(image.directions, DirectionRanges{});
  EXPECT_EQ(image.readings->heading_rad, 1.0);
}

}  // namespace
}  // namespace sonard::server
