// SPDX-License-Identifier: Apache-2.0
// Maps a ping of a Micron to the renderer's settings. Only this file uses both.
#pragma once

#include "protocol/common/ping_job.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/devices/micron/config.hpp"

namespace sonard::server {

/// Renderer settings of one ping: the head's acoustics with the job's bins, the range cell of its chirp at
/// the true sound speed, and the difference between the client's gain and the nominal gain added.
render::SonarSettings micron_sonar_settings(const PingJob& job, const HeadConfig& head);

}  // namespace sonard::server
