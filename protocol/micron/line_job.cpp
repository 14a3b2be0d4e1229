// SPDX-License-Identifier: Apache-2.0
#include "protocol/micron/line_job.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "protocol/micron/line_timing.hpp"
#include "protocol/micron/settings_text.hpp"
#include "protocol/micron/units.hpp"

namespace sonard::micron {
namespace {

/// @param interval time between two bins, in units of the wire
void set_bins(PingJob& job, int bins, int interval, double sound_speed_mps) {
  job.native_bins = bins;
  job.sound_speed_mps = sound_speed_mps;
  job.native_bin_m = bin_time_s(interval) * sound_speed_mps / 2.0;
  job.listening_time = std::chrono::nanoseconds{static_cast<std::int64_t>(1e9 * bins * bin_time_s(interval))};
}

void set_gain(PingJob& job, int gain) {
  job.gain_db = gain_db(gain);
  job.gain_percent = 100.0 * job.gain_db / full_scale_db;
}

}  // namespace

PingJob make_line_job(const HeadCommand& parameters, const DeviceConfig& config, int bearing) {
  PingJob job;
  const bool mirrored = parameters.has(control_bits::invert) != config.mounted_inverted;
  job.bearing_rad = (mirrored ? -1.0 : 1.0) * bearing_rad(bearing);
  set_bins(job, effective_bins(parameters), effective_ad_interval(parameters), config.water_sound_speed_mps);
  set_gain(job, parameters.gain[0]);
  job.transmit = !parameters.has(control_bits::transmit_off);
  job.settings = settings_of(job, parameters, config);
  return job;
}

PingJob make_line_job(const ReplayedPing& recorded, const HeadData& line) {
  PingJob job;
  job.bearing_rad = recorded.bearing_rad;
  set_bins(job, recorded.settings.bins, std::max<int>(line.ad_interval, 1),
           recorded.settings.sound_speed_mps);
  set_gain(job, line.gain);
  job.transmit = (line.control & control_bits::transmit_off) == 0;
  job.settings = settings_of(job, line);
  return job;
}

}  // namespace sonard::micron
