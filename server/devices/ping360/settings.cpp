// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping360/settings.hpp"

#include <algorithm>

#include "protocol/ping360/units.hpp"
#include "renderer/acoustics/transducer.hpp"
#include "renderer/acoustics/water.hpp"
#include "server/devices/single_beam.hpp"

namespace sonard::server {
namespace {

// Levels were set with the settings that clients use at 10 m (protocol/ping360/README.md 2.3).
constexpr double usual_pulse_s = 53e-6;
constexpr int usual_sample_period = 444;

/// Changes wavelength and absorption to the values at another frequency. The head's error in the absorption
/// of its water stays as at its usual frequency.
void follow_frequency(double frequency_hz, const Ping360Config& config, render::PhysicalModel& physical) {
  physical.multipath.wavelength_m *= ping360_carrier_hz / frequency_hz;
  if (config.water) {
    const double change_db_per_m =
        render::francois_garrison_absorption_db_per_m(frequency_hz, *config.water) -
        render::francois_garrison_absorption_db_per_m(ping360_carrier_hz, *config.water);
    physical.absorption_db_per_m += change_db_per_m;
    physical.tvg.absorption_db_per_m = std::max(0.0, physical.tvg.absorption_db_per_m + change_db_per_m);
  }
}

}  // namespace

render::SonarSettings ping360_sonar_settings(const PingJob& job, const HeadConfig& head) {
  const Ping360Config& config = device_settings<Ping360Config>(head);
  render::SonarSettings settings = single_beam_settings(job, head);
  render::PhysicalModel& physical = settings.physical;
  physical.pulse.range_cell_m = job.sound_speed_mps * job.pulse_s / 2.0;
  physical.pulse.usual = {job.sound_speed_mps * usual_pulse_s / 2.0,
                          job.sound_speed_mps * ping360::sample_time_s(usual_sample_period) / 2.0};
  // The transducer can receive only after its tone ends, and then rings.
  const double longer_m = std::max(0.0, physical.pulse.range_cell_m - physical.pulse.usual.cell_m);
  physical.ring_down.peak_m += longer_m;
  physical.ring_down.end_m += longer_m;
  const double frequency_hz = job.frequency_hz > 0 ? job.frequency_hz : ping360_carrier_hz;
  physical.pulse.band_loss_db = render::band_loss_db(config.transducer_band, frequency_hz, job.pulse_s);
  follow_frequency(frequency_hz, config, physical);
  return settings;
}

// Beam of 2 by 25 degrees, from the maker's data sheet. The law of the samples is not published. Assumed:
// half decibels, as in the other scanning head, with a wall 5 m away in the upper half of the scale. Nearer
// than 0.75 m the transducer rings, and images of owners are bright from the first sample on
// (protocol/ping360/README.md 2.3).
render::SonarSettings ping360_acoustics() {
  render::SonarSettings acoustics = single_beam_acoustics(2.0, 25.0);
  acoustics.output_scale = render::OutputScale::half_decibels;
  acoustics.physical.multipath.most_bounces = 6;
  acoustics.physical.pulse.shape = render::PulseSettings::Shape::tone;
  acoustics.physical.gain_db = -9.0;
  acoustics.physical.tvg.max_db = 75.0;
  acoustics.physical.noise.level_db = -141.0;
  acoustics.physical.near_field_blank_m = 0.0;
  acoustics.physical.ring_down.end_m = 0.75;
  acoustics.physical.ring_down.from_start = true;
  return acoustics;
}

}  // namespace sonard::server
