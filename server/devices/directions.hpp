// SPDX-License-Identifier: Apache-2.0
// Pings of heads that measure directions, from the device to the renderer and back.
#pragma once

#include <cstdint>
#include <optional>

#include "protocol/common/ping_job.hpp"
#include "renderer/ping.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::server {

/// Sets directions, aperture and range bins as the job has them.
/// @param horizontal_beamwidth_rad, vertical_beamwidth_rad -3 dB full width of a beam, two-way
void set_directions(const PingJob& job, double horizontal_beamwidth_rad, double vertical_beamwidth_rad,
                    render::SonarSettings& settings);

/// The renderer's answer as the device gets it.
PingImage image_of(std::uint64_t number, render::PingSamples samples, std::optional<SensorReadings> readings);

}  // namespace sonard::server
