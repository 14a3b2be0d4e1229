// SPDX-License-Identifier: Apache-2.0
// What the renderer is asked for by a ping of a Ping360.
#include "server/devices/ping360/settings.hpp"

#include <gtest/gtest.h>

#include "protocol/ping360/make_job.hpp"
#include "server/devices/ping360/config.hpp"
#include "server/devices/ping360/kind.hpp"

namespace sonard::server {
namespace {

render::SonarSettings settings_of(const ping360::Transducer& command) {
  const HeadConfig head = ping360_kind().make_default();
  return ping360_sonar_settings(ping360::make_job(ping360::form_of(command), ping360_config(head).device),
                                head);
}

ping360::Transducer usual_command() {
  ping360::Transducer command;
  command.number_of_samples = 1200;
  command.sample_period = 888;
  command.transmit_duration_us = 100;
  return command;
}

// docs/protocols/ping360.md 2.3: the sample interval is 888 * 25 ns, two ways; a pulse of 100 us is 75 mm
// long.
TEST(Ping360Settings, ranges_and_pulse_are_those_of_the_command) {
  const render::SonarSettings settings = settings_of(usual_command());
  EXPECT_EQ(settings.range.count, 1200);
  EXPECT_NEAR(settings.range.step_m, 888 * 25e-9 * 1500.0 / 2.0, 1e-12);
  EXPECT_NEAR(settings.physical.range_cell_m, 0.075, 1e-12);
  EXPECT_TRUE(settings.transmit);
}

TEST(Ping360Settings, the_three_gains_are_six_decibels_apart) {
  ping360::Transducer command = usual_command();
  command.gain_setting = 0;
  const double low_db = settings_of(command).physical.gain_db;
  command.gain_setting = 2;
  EXPECT_NEAR(settings_of(command).physical.gain_db - low_db, 12.0, 1e-12);
}

}  // namespace
}  // namespace sonard::server
