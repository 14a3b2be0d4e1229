// SPDX-License-Identifier: Apache-2.0
// Settings of the renderer for a ping of a Ping360.
#include "server/devices/ping360/settings.hpp"

#include <gtest/gtest.h>

#include "protocol/ping360/make_job.hpp"
#include "server/devices/ping360/config.hpp"
#include "server/devices/ping360/type.hpp"

namespace sonard::server {
namespace {

render::SonarSettings settings_of(const ping360::Transducer& command) {
  const HeadConfig head = ping360_type().make_default();
  return ping360_sonar_settings(
      ping360::make_job(ping360::form_of(command), device_settings<Ping360Config>(head).device), head);
}

ping360::Transducer usual_command() {
  ping360::Transducer command;
  command.number_of_samples = 1200;
  command.sample_period = 888;
  command.transmit_duration_us = 100;
  return command;
}

// protocol/ping360/README.md 2.3: the sample interval is the two-way time 888 * 25 ns. A pulse of 100 us is
// 75 mm long.
TEST(Ping360Settings, RangesAndPulseAreThoseOfTheCommand) {
  const render::SonarSettings settings = settings_of(usual_command());
  EXPECT_EQ(settings.range.count, 1200);
  EXPECT_NEAR(settings.range.step_m, 888 * 25e-9 * 1500.0 / 2.0, 1e-12);
  EXPECT_NEAR(settings.physical.pulse.range_cell_m, 0.075, 1e-12);
  EXPECT_TRUE(settings.transmit);
}

// The transducer cannot receive before its tone ends. A tone of 1000 us is 0.675 m longer than one of 100 us.
TEST(Ping360Settings, TheRingDownLastsAsMuchLongerAsTheTone) {
  const render::RingDown usual = settings_of(usual_command()).physical.ring_down;
  ping360::Transducer command = usual_command();
  command.transmit_duration_us = 1000;
  const render::RingDown longer = settings_of(command).physical.ring_down;
  EXPECT_NEAR(longer.peak_m - usual.peak_m, 0.675, 1e-9);
  EXPECT_NEAR(longer.end_m - usual.end_m, 0.675, 1e-9);
  command.transmit_duration_us = 5;
  EXPECT_NEAR(settings_of(command).physical.ring_down.end_m, 0.75, 1e-9);
}

// Absorption in the sea by Francois & Garrison, cool water: about 0.13 dB/m at 500 kHz, 0.36 dB/m at 1000
// kHz.
TEST(Ping360Settings, LevelAndAbsorptionAreThoseOfTheFrequency) {
  ping360::Transducer command = usual_command();
  EXPECT_NEAR(settings_of(command).physical.pulse.band_loss_db, 0, 0.01);
  const double usual_db_per_m = settings_of(command).physical.absorption_db_per_m;
  const double usual_wavelength_m = settings_of(command).physical.multipath.wavelength_m;
  command.transmit_frequency_khz = 500;
  EXPECT_NEAR(settings_of(command).physical.pulse.band_loss_db, -20.1, 0.1);
  EXPECT_NEAR(settings_of(command).physical.multipath.wavelength_m, usual_wavelength_m * 740 / 500, 1e-9);
  const double low_db_per_m = settings_of(command).physical.absorption_db_per_m;
  command.transmit_frequency_khz = 1000;
  EXPECT_NEAR(settings_of(command).physical.pulse.band_loss_db, -15.5, 0.1);
  const double high_db_per_m = settings_of(command).physical.absorption_db_per_m;
  EXPECT_NEAR(high_db_per_m - low_db_per_m, 0.21, 0.06);
  EXPECT_LT(low_db_per_m, usual_db_per_m);
  EXPECT_LT(usual_db_per_m, high_db_per_m);
}

TEST(Ping360Settings, TheThreeGainsAreSixDecibelsApart) {
  ping360::Transducer command = usual_command();
  command.gain_setting = 0;
  const double low_db = settings_of(command).physical.gain_db;
  command.gain_setting = 2;
  EXPECT_NEAR(settings_of(command).physical.gain_db - low_db, 12.0, 1e-12);
}

}  // namespace
}  // namespace sonard::server
