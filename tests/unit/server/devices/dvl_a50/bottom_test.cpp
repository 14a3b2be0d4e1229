// SPDX-License-Identifier: Apache-2.0
// Slant ranges from the renderer against a plane cut by the axes of the beams (protocol/dvl_a50/README.md 3).
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "protocol/dvl_a50/beams.hpp"
#include "protocol/dvl_a50/measurement.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "server/devices/directions.hpp"
#include "server/devices/dvl_a50/settings.hpp"
#include "server/devices/dvl_a50/type.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::server {
namespace {

/// The ranges over a plane that rises by `slope_rad` to the east, `height_m` below a device that looks down,
/// forward to the east.
std::array<double, 4> ranges_over(double height_m, double slope_rad) {
  const auto h = static_cast<float>(height_m);
  const auto rise = static_cast<float>(std::tan(slope_rad));
  const render::Body bed = test::make_body(
      "bed", test::make_quad({-200, -200, -h - 200 * rise}, {400, 0, 400 * rise}, {0, 400, 0}), 0.3);
  render::SonarRenderer renderer(test::make_world({bed}), {render::EngineKind::cpu, 1});
  const HeadConfig head = dvl_a50_type().make_default();
  const dvl_a50::DeviceConfig& device = device_settings<DvlConfig>(head).device;
  const PingJob job = dvl_a50::make_job(dvl_a50::plan_ping(std::nullopt, device, device.settings), device);
  render::PingRequest request;
  request.settings = dvl_sonar_settings(job, head);
  request.T_world_sonar.orientation = glm::dquat(glm::dvec3(0, std::numbers::pi / 2, 0));
  const PingImage image = image_of(0, renderer.render_ping(request, 0), std::nullopt);
  const auto ranges_m = dvl_a50::beam_ranges_m(image.directions);
  EXPECT_TRUE(ranges_m);
  return ranges_m.value_or(std::array<double, 4>{});
}

/// Along the axis of a beam, closed form: x east (forward), z down.
double range_of(const dvl_a50::Vector& u, double height_m, double slope_rad) {
  return height_m / (u[2] + u[0] * std::tan(slope_rad));
}

// A beam of 4.4 degrees that meets a plane under 22.5 degrees covers 3 % of its range.
TEST(DvlBottom, RangesOverAFlatBottomAreThoseOfTheAxes) {
  for (const double height_m : {0.3, 2.0, 12.0, 40.0}) {
    const std::array<double, 4> ranges_m = ranges_over(height_m, 0.0);
    for (std::size_t beam = 0; beam < 4; ++beam) {
      const double expected_m = range_of(dvl_a50::beam_directions[beam], height_m, 0.0);
      EXPECT_NEAR(ranges_m[beam] / expected_m, 1.0, 0.003) << height_m << " " << beam;
    }
  }
}

TEST(DvlBottom, OverASlopeEachBeamHasItsOwnRange) {
  for (const double slope_deg : {-15.0, 5.0, 15.0, 25.0}) {
    const double slope_rad = slope_deg * std::numbers::pi / 180.0;
    const std::array<double, 4> ranges_m = ranges_over(5.0, slope_rad);
    for (std::size_t beam = 0; beam < 4; ++beam) {
      const double expected_m = range_of(dvl_a50::beam_directions[beam], 5.0, slope_rad);
      EXPECT_NEAR(ranges_m[beam] / expected_m, 1.0, 0.008) << slope_deg << " " << beam;
    }
  }
}

TEST(DvlBottom, OpenWaterIsNoEcho) {
  EXPECT_EQ(ranges_over(150.0, 0.0), (std::array<double, 4>{}));
}

}  // namespace
}  // namespace sonard::server
