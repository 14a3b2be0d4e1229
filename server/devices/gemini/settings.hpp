// SPDX-License-Identifier: Apache-2.0
// The one place that knows both a ping of a Gemini and the renderer's settings.
#pragma once

#include "protocol/common/ping_job.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/devices/gemini/config.hpp"

namespace sonard::server {

/// Renderer settings of one ping.
/// @return the acoustics of the head with the beams of a 720i (docs/protocols/gemini.md 6.5) as the water
///   steers them, the range bins, the sample size and the length of the pulse of the job, and the gain moved
///   by the job's. A head that only listens receives no echo.
render::SonarSettings gemini_sonar_settings(const PingJob& job, const HeadConfig& head);

}  // namespace sonard::server
