// SPDX-License-Identifier: Apache-2.0
// Water with another sound speed than the client assumes (docs/physics.md 2.12): a range r is displayed as
// r c_d / c. The tests go from the client's settings over the head's job to the image.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "protocol/gemini/ping_plan.hpp"
#include "protocol/gemini/ping_settings.hpp"
#include "server/devices/gemini/settings.hpp"
#include "server/devices/gemini/type.hpp"
#include "server/devices/micron/settings.hpp"
#include "server/devices/micron/type.hpp"
#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::server {
namespace {

using namespace test;

constexpr double assumed_mps = 1500.0;

/// The job of a head whose client requests 20 m at 1500 m/s, in water of another speed.
PingJob gemini_job(double water_mps) {
  gemini::PingSettings settings;
  settings.range_m = 20.0;
  settings.sound_speed_mps = assumed_mps;
  gemini::DeviceConfig device;
  device.water_sound_speed_mps = water_mps;
  return gemini::plan_ping(gemini::make_ping_config(settings), device)->job;
}

/// Range that a client shows, m: lines times the speed that it assumes.
double shown_m(double lines, double line_rate_hz) {
  return lines * assumed_mps / (2 * line_rate_hz);
}

int first_line(const render::EchoImage& image, int beam) {
  int line = 0;
  while (line < image.bins && image.at(beam, line) == 0.0F) {
    ++line;
  }
  return line;
}

class SoundSpeed : public EngineTest {
 protected:
  static render::EchoImage image_of(const render::World& world, render::SonarSettings settings) {
    settings.aperture.azimuth = render::Aperture::Azimuth::ideal;
    settings.physical.pulse.range_cell_m = 0;  // a pulse spreads an echo before and behind its range
    render::SonarRenderer renderer(world, options());
    return renderer.render_echo({{}, settings});
  }
};
INSTANTIATE_TEST_SUITE_P(Propagation, SoundSpeed, all_engines(), engine_name);

TEST_P(SoundSpeed, GeminiShowsAWallAtTheRatioOfTheSpeeds) {
  const render::World wall =
      make_world({make_body("wall", make_quad({12, -30, -5}, {0, 60, 0}, {0, 0, 10}))});
  for (const double water_mps : {1500.0, 1450.0, 1545.0}) {
    render::SonarSettings settings =
        gemini_sonar_settings(gemini_job(water_mps), gemini_type().make_default());
    settings.aperture.beam_edges_rad = render::equal_angle_edges(2, 1 * degree);
    const render::EchoImage image = image_of(wall, settings);
    const double line_m = shown_m(1, 90'422.0);
    const int expected = static_cast<int>(12.0 * assumed_mps / water_mps / line_m);
    EXPECT_NEAR(first_line(image, 0), expected, 1) << water_mps;
  }
}

TEST_P(SoundSpeed, MicronToo) {
  const render::World wall = make_world({make_body("wall", make_quad({6, -5, -5}, {0, 10, 0}, {0, 0, 10}))});
  for (const double water_mps : {1500.0, 1450.0, 1545.0}) {
    constexpr double bin_time_s = 52 * 640e-9;
    PingJob job;
    job.native_bins = 400;
    job.sound_speed_mps = water_mps;
    job.native_bin_m = bin_time_s * water_mps / 2;
    const render::EchoImage image = image_of(wall, micron_sonar_settings(job, micron_type().make_default()));
    const double bin_m = shown_m(1, 1 / bin_time_s);
    EXPECT_NEAR(first_line(image, 0), static_cast<int>(6.0 * assumed_mps / water_mps / bin_m), 1)
        << water_mps;
  }
}

// sin psi' = sin psi c_d / c: in slow water a post to port appears farther to port.
TEST_P(SoundSpeed, FlatArrayHearsAPostWhereItsDelaysPoint) {
  const double bearing = 35 * degree;
  const auto at = static_cast<float>(10 * std::sin(bearing));
  const render::World post = make_world(
      {make_body("post", make_quad({10 * std::cos(bearing), at - 0.015F, -0.5F}, {0, 0.03F, 0}, {0, 0, 1}))});
  for (const bool error : {false, true}) {
    GeminiConfig config;
    config.steering_error = error;
    HeadConfig head = gemini_type().make_default();
    head.device = std::make_shared<GeminiConfig>(config);
    const render::EchoImage image = image_of(post, gemini_sonar_settings(gemini_job(1450.0), head));
    const auto loudest = std::max_element(image.intensity.begin(), image.intensity.end());
    ASSERT_GT(*loudest, 0.0F);
    const auto beam = (loudest - image.intensity.begin()) / image.bins;
    // The 256 beams are even in the sine of the bearing, from 60 degrees to port downwards.
    const double shown_sin = std::sin(bearing) * (error ? assumed_mps / 1450.0 : 1.0);
    EXPECT_EQ(beam, static_cast<int>(128 - 128 * shown_sin / std::sin(60 * degree))) << error;
  }
}

}  // namespace
}  // namespace sonard::server
