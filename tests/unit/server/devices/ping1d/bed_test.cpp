// SPDX-License-Identifier: Apache-2.0
// Distances in rendered pings: the renderer's samples, with speckle and noise as configured, to the head's
// measurement (protocol/ping1d/README.md 3.4).
#include <chrono>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "protocol/ping1d/auto_mode.hpp"
#include "protocol/ping1d/echo.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "server/devices/ping1d/settings.hpp"
#include "server/devices/ping1d/type.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::server {
namespace {

render::Body flat_bed(float z_m) {
  return test::make_body("bed", test::make_quad({-200, -200, z_m}, {400, 0, 0}, {0, 400, 0}), 0.3);
}

/// A head that looks straight down, at the origin.
class Sounder {
 public:
  Sounder(const render::World& world, Ping1dModel model, bool speckle)
      : head_(ping1d_type().make_default()), renderer_(world, {render::EngineKind::cpu, 1}) {
    head_.acoustics = ping1d_acoustics(model);
    if (!speckle) {
      head_.acoustics.physical.speckle.kind = render::SpeckleSettings::Kind::off;
      head_.acoustics.physical.noise.on = false;
    }
  }

  ping1d::Echo ping(const ping1d::Scan& scan) {
    const ping1d::DeviceConfig& device = device_settings<Ping1dConfig>(head_).device;
    render::PingRequest request;
    request.ping_number = number_++;
    request.settings = ping1d_sonar_settings(ping1d::make_job(scan, device), head_);
    request.T_world_sonar.orientation = glm::dquat(glm::dvec3(0, std::numbers::pi / 2, 0));
    const PingImage image{.number = 0, .u8 = {}, .u16 = renderer_.render_ping(request, 0).u16};
    return ping1d::find_echo(ping1d::amplitudes(image), scan, device.points, 1e3 * device.least_range_m);
  }

  /// The echo after so many pings in auto mode.
  ping1d::Echo settled(int pings) {
    ping1d::Scan scan;
    ping1d::Echo echo;
    for (int i = 0; i < pings; ++i) {
      echo = ping(scan);
      scan = ping1d::next_auto_scan(scan, echo, device_settings<Ping1dConfig>(head_).device);
    }
    return echo;
  }

 private:
  HeadConfig head_;
  render::SonarRenderer renderer_;
  std::uint64_t number_ = 0;
};

TEST(Ping1dBed, AFlatBedIsWithin1MmWithoutSpeckle) {
  for (const float range_m : {0.8F, 1.234F, 3.2F, 4.0F, 7.77F, 13.0F, 25.0F, 40.0F, 47.0F}) {
    for (const Ping1dModel model : {Ping1dModel::ping1d, Ping1dModel::ping2}) {
      Sounder sounder(test::make_world({flat_bed(-range_m)}), model, false);
      const ping1d::Echo echo = sounder.settled(12);
      ASSERT_TRUE(echo.distance_mm) << range_m;
      EXPECT_NEAR(*echo.distance_mm, 1e3 * static_cast<double>(range_m), 1.0) << range_m;
    }
  }
}

TEST(Ping1dBed, AFlatBedIsWithinTwoSamplesWithSpeckleAndNoise) {
  for (const float range_m : {1.234F, 4.0F, 13.0F, 40.0F}) {
    Sounder sounder(test::make_world({flat_bed(-range_m)}), Ping1dModel::ping2, true);
    const ping1d::Echo echo = sounder.settled(12);
    ASSERT_TRUE(echo.distance_mm) << range_m;
    EXPECT_NEAR(*echo.distance_mm, 1e3 * static_cast<double>(range_m), 1.0 + 2e-3 * 1e3 * range_m) << range_m;
    EXPECT_GT(echo.confidence_percent, 50.0) << range_m;
  }
}

TEST(Ping1dBed, OverAStepTheStrongerEchoIsTheDistance) {
  render::Body block =
      test::make_body("block", test::make_quad({-5, -0.2F, -3}, {10, 0, 0}, {0, 20, 0}), 0.3);
  Sounder over_block(test::make_world({flat_bed(-5), block}), Ping1dModel::ping1d, false);
  EXPECT_NEAR(over_block.settled(12).distance_mm.value_or(0), 3000.0, 1.0);
  block = test::make_body("block", test::make_quad({-5, 0.2F, -3}, {10, 0, 0}, {0, 20, 0}), 0.00001);
  Sounder over_foam(test::make_world({flat_bed(-5), block}), Ping1dModel::ping1d, false);
  EXPECT_NEAR(over_foam.settled(12).distance_mm.value_or(0), 5000.0, 1.0) << "the nearer echo is weak";
}

TEST(Ping1dBed, OpenWaterIsNoEcho) {
  Sounder sounder(test::make_world({flat_bed(-300)}), Ping1dModel::ping2, true);
  EXPECT_FALSE(sounder.settled(15).distance_mm);
}

}  // namespace
}  // namespace sonard::server
