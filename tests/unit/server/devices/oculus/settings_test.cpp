// SPDX-License-Identifier: Apache-2.0
// Settings of the renderer for a ping of an Oculus.
#include "server/devices/oculus/settings.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "protocol/oculus/image_form.hpp"
#include "protocol/oculus/ping_plan.hpp"
#include "server/devices/oculus/config.hpp"
#include "server/devices/oculus/type.hpp"
#include "tests/support/degree.hpp"

namespace sonard::server {
namespace {

oculus::SimpleFire fire_with(int mode, int beams) {
  oculus::SimpleFire fire;
  fire.fire.master_mode = static_cast<std::uint8_t>(mode);
  fire.fire.range = 15.0;
  fire.fire.sound_speed_mps = 1500.0;
  fire.fire.flags |= beams == 512 ? oculus::fire_flags::beams_512 : 0;
  return fire;
}

render::SonarSettings settings_of(const oculus::SimpleFire& fire,
                                  const HeadConfig& head = oculus_type().make_default()) {
  const oculus::PlanConfig& plan = device_settings<OculusConfig>(head).device.plan;
  return oculus_sonar_settings(oculus::job_of(oculus::plan_ping(fire, plan), plan), head);
}

// protocol/oculus/README.md 4.5: bearings are positive to starboard, but the renderer counts to port. By its
// sine, each bearing is the middle of its beam.
TEST(OculusSettings, BeamsHoldTheBearingsOfTheTableAtBothFrequencies) {
  for (const auto& [mode, half_deg] : {std::pair{1, 65.0}, {2, 35.0}}) {
    for (const int beams : {256, 512}) {
      const std::vector<double> edges = settings_of(fire_with(mode, beams)).aperture.beam_edges_rad;
      ASSERT_EQ(edges.size(), static_cast<std::size_t>(beams) + 1);
      const auto bearings = oculus::bearings_cdeg(beams, half_deg);
      for (std::size_t beam = 0; beam < bearings.size(); ++beam) {
        const double middle = std::asin((std::sin(edges[beam]) + std::sin(edges[beam + 1])) / 2);
        EXPECT_NEAR(-middle / degree, bearings[beam] / 100.0, 0.0101) << beam;
      }
    }
  }
}

TEST(OculusSettings, RowsAreThoseOfThePing) {
  const render::SonarSettings settings = settings_of(fire_with(1, 512));
  EXPECT_EQ(settings.range.count, 1048);  // 15 m in rows of 5 samples at 262 237.76 Hz
  EXPECT_NEAR(settings.range.step_m, 5 * 1500.0 / (2 * 37.5e6 / 143), 1e-12);
  EXPECT_EQ(settings.range.output_count(), 1048);
}

TEST(OculusSettings, RowsKeepTheirTimeInWaterOfAnotherSpeed) {
  HeadConfig head = oculus_type().make_default();
  auto config = std::make_shared<OculusConfig>(device_settings<OculusConfig>(head));
  config->device.plan.water_sound_speed_mps = 1450.0;
  head.device = config;
  EXPECT_NEAR(settings_of(fire_with(1, 512), head).range.step_m, 5 * 1450.0 / (2 * 37.5e6 / 143), 1e-12);
}

TEST(OculusSettings, FrequenciesHaveBeamsWaterAndNoiseOfTheirOwn) {
  const render::SonarSettings low = settings_of(fire_with(1, 256));
  const render::SonarSettings high = settings_of(fire_with(2, 256));
  EXPECT_NEAR(low.aperture.receive_beamwidth_rad, 1.0 * degree, 1e-12);
  EXPECT_NEAR(high.aperture.receive_beamwidth_rad, 0.6 * degree, 1e-12);
  EXPECT_NEAR(low.physical.pulse.range_cell_m, 4e-3, 1e-12);
  EXPECT_NEAR(high.physical.pulse.range_cell_m, 2.5e-3, 1e-12);
  EXPECT_NEAR(low.physical.multipath.wavelength_m / high.physical.multipath.wavelength_m, 1200.0 / 750.0,
              1e-9);
  EXPECT_GT(high.physical.absorption_db_per_m, 1.5 * low.physical.absorption_db_per_m);
  // The time-varied gain uses the absorption at each frequency.
  EXPECT_NEAR(high.physical.tvg.absorption_db_per_m - low.physical.tvg.absorption_db_per_m,
              high.physical.absorption_db_per_m - low.physical.absorption_db_per_m, 1e-12);
  // Thermal noise rises with 20 log10 of the frequency.
  EXPECT_NEAR(high.physical.noise.level_db - low.physical.noise.level_db, 20 * std::log10(1200.0 / 750.0),
              1e-9);
}

// protocol/oculus/README.md 8.
TEST(OculusSettings, ModelsHaveBeamsOfTheirOwn) {
  struct Case {
    oculus::Model model;
    int mode;
    double resolution_deg, vertical_deg, half_deg, frequency_hz;
  };
  for (const Case& it :
       {Case{oculus::m1200d, 1, 0.6, 20.0, 65.0, 1.2e6}, Case{oculus::m3000d, 1, 0.6, 20.0, 65.0, 1.2e6},
        Case{oculus::m3000d, 2, 0.4, 12.0, 20.0, 3e6}, Case{oculus::m370s, 1, 2.0, 20.0, 65.0, 375e3},
        Case{oculus::m370s, 2, 2.0, 20.0, 65.0, 375e3}, Case{oculus::c550d, 1, 1.4, 20.0, 65.0, 550e3},
        Case{oculus::c550d, 2, 0.9, 20.0, 35.0, 820e3}}) {
    SCOPED_TRACE(it.model.name);
    HeadConfig head = oculus_type().make_default();
    auto config = std::make_shared<OculusConfig>(device_settings<OculusConfig>(head));
    config->device.plan.model = it.model;
    config->modes = oculus_modes(it.model);
    head.device = config;
    const render::SonarSettings settings = settings_of(fire_with(it.mode, 256), head);
    EXPECT_NEAR(settings.aperture.receive_beamwidth_rad, it.resolution_deg * degree, 1e-12);
    EXPECT_NEAR(settings.aperture.vertical_beamwidth_rad, it.vertical_deg * degree, 1e-12);
    EXPECT_NEAR(std::sin(settings.aperture.beam_edges_rad.front()),
                std::sin(it.half_deg * degree) * 256.0 / 255.0, 1e-9);
    EXPECT_NEAR(1482.0 / settings.physical.multipath.wavelength_m, it.frequency_hz, 0.02 * it.frequency_hz);
  }
}

TEST(OculusSettings, GammaAndGainAreTheClients) {
  oculus::SimpleFire fire = fire_with(1, 256);
  fire.fire.gamma = 127;
  const render::SonarSettings settings = settings_of(fire);
  EXPECT_EQ(settings.output_scale, render::OutputScale::power);
  EXPECT_NEAR(settings.output_exponent, 127.0 / 255.0, 1e-12);
  fire.fire.gamma = 0;
  fire.fire.gain_percent = 60.0;
  EXPECT_EQ(settings_of(fire).output_exponent, 1.0);
  EXPECT_NEAR(settings_of(fire).physical.gain_db - settings.physical.gain_db, 6.0, 1e-12);
  fire.fire.flags |= oculus::fire_flags::sixteen_bit;
  EXPECT_TRUE(settings_of(fire).sixteen_bit);
}

}  // namespace
}  // namespace sonard::server
