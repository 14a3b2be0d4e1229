// SPDX-License-Identifier: Apache-2.0
// Maps a ping of a Ping1D to the renderer's settings. Only this file uses both.
#pragma once

#include "protocol/common/ping_job.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/devices/ping1d/config.hpp"

namespace sonard::server {

/// Renderer settings of one ping: the head's acoustics with the job's bins and gain.
render::SonarSettings ping1d_sonar_settings(const PingJob& job, const HeadConfig& head);

}  // namespace sonard::server
