// SPDX-License-Identifier: Apache-2.0
// Maps a ping of a DVL to the renderer's settings. Only this file uses both.
#pragma once

#include "protocol/common/ping_job.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/devices/dvl_a50/config.hpp"

namespace sonard::server {

/// Renderer settings of one ping: the head's acoustics with the directions and bins of the job.
render::SonarSettings dvl_sonar_settings(const PingJob& job, const HeadConfig& head);

}  // namespace sonard::server
