// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping360/make_job.hpp"

#include <algorithm>

#include "protocol/ping360/settings_text.hpp"
#include "protocol/ping360/units.hpp"

namespace sonard::ping360 {
namespace {

PingJob job_of(const PingForm& form, const DeviceConfig& config, int samples, double sound_speed_mps) {
  const DeviceData& settings = form.settings;
  const std::size_t gain = std::min<std::size_t>(settings.gain_setting, config.gain_db.size() - 1);
  PingJob job;
  job.native_bins = samples;
  job.native_bin_m = sample_time_s(settings.sample_period) * sound_speed_mps / 2.0;
  job.listening_time = listening_time(samples, settings.sample_period);
  job.sound_speed_mps = sound_speed_mps;
  job.pulse_s = settings.transmit_duration_us * 1e-6;
  job.frequency_hz = settings.transmit_frequency_khz * 1e3;
  job.gain_db = config.gain_db[gain];
  job.gain_percent = 50.0 * static_cast<double>(gain);
  return job;
}

}  // namespace

PingJob make_job(const PingForm& form, const DeviceConfig& config) {
  PingJob job = job_of(form, config, form.settings.number_of_samples, config.water_sound_speed_mps);
  job.bearing_rad = bearing_rad(form.settings.angle, config.bearing_offset);
  job.settings = settings_of(job, form);
  return job;
}

PingJob make_job(const ReplayedPing& recorded, const PingForm& form, const DeviceConfig& config) {
  PingJob job = job_of(form, config, recorded.settings.bins, recorded.settings.sound_speed_mps);
  job.bearing_rad = recorded.bearing_rad;
  job.settings = settings_of(job, {form.settings, std::nullopt});
  return job;
}

}  // namespace sonard::ping360
