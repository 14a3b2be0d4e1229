// SPDX-License-Identifier: Apache-2.0
#include "server/devices/directions.hpp"

#include <utility>

namespace sonard::server {

void set_directions(const PingJob& job, double horizontal_beamwidth_rad, double vertical_beamwidth_rad,
                    render::SonarSettings& settings) {
  const Directions& asked = job.directions;
  settings.directions = {.columns = asked.columns,
                         .rows = asked.rows,
                         .azimuth_fov_rad = asked.horizontal_fov_rad,
                         .elevation_fov_rad = asked.vertical_fov_rad,
                         .azimuth_beamwidth_rad = horizontal_beamwidth_rad,
                         .elevation_beamwidth_rad = vertical_beamwidth_rad,
                         .nearest_m = asked.nearest_m};
  settings.aperture = direction_aperture(settings.directions);
  settings.range = {.count = job.native_bins, .step_m = job.native_bin_m};
}

PingImage image_of(std::uint64_t number, render::PingSamples samples,
                   std::optional<SensorReadings> readings) {
  render::DirectionEchoes& echoes = samples.directions;
  return {
      .number = number,
      .u8 = std::move(samples.u8),
      .u16 = std::move(samples.u16),
      .readings = readings,
      .directions = {echoes.columns, echoes.rows, std::move(echoes.range_m), std::move(echoes.intensity)}};
}

}  // namespace sonard::server
