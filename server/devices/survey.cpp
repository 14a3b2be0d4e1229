// SPDX-License-Identifier: Apache-2.0
#include "server/devices/survey.hpp"

#include <utility>

namespace sonard::server {

PingRecord Survey::record(int ping, std::vector<std::uint8_t> samples) const {
  const PingJob job = this->job(ping);
  PingRecord record;
  record.number = job.number;
  record.bearings_rad = bearings_rad();
  if (record.bearings_rad.empty()) {
    record.bearings_rad = {job.bearing_rad};
  }
  record.sector_rad = record.bearings_rad.back() - record.bearings_rad.front();
  record.settings.bins = job.bins();
  record.settings.beams = static_cast<int>(record.bearings_rad.size());
  record.settings.bin_m = job.bin_m();
  record.settings.sound_speed_mps = job.sound_speed_mps;
  record.settings.gain_percent = job.gain_percent;
  record.settings.amplitude_exponent = job.amplitude_exponent;
  record.samples = std::move(samples);
  return record;
}

PingRecord Survey::record_of_measured(int ping, const DirectionRanges&, std::int64_t) const {
  return record(ping, {});
}

}  // namespace sonard::server
