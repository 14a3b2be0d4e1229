// SPDX-License-Identifier: Apache-2.0
// Maps a shot of a Sonar 3D-15 to the renderer's settings. Only this file uses both.
#pragma once

#include "protocol/common/ping_job.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/devices/sonar3d15/config.hpp"

namespace sonard::server {

/// Renderer settings of one shot: the head's acoustics with the directions, range and frequency of the job.
render::SonarSettings sonar3d15_sonar_settings(const PingJob& job, const HeadConfig& head);

}  // namespace sonard::server
