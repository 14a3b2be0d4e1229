// SPDX-License-Identifier: Apache-2.0
// Maps a ping of a Gemini to the renderer's settings. Only this file uses both.
#pragma once

#include "protocol/common/ping_job.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/devices/gemini/config.hpp"

namespace sonard::server {

/// Renderer settings of one ping.
/// @return the acoustics of the head with the beams of a 720i (protocol/gemini/README.md 6.5), steered by the
/// water's sound speed, with the job's range bins, sample size and pulse length, and with the job's gain
/// added. A head that only listens receives no echo.
render::SonarSettings gemini_sonar_settings(const PingJob& job, const HeadConfig& head);

}  // namespace sonard::server
