// SPDX-License-Identifier: Apache-2.0
// The one place that knows both a ping of a Ping360 and the renderer's settings.
#pragma once

#include "protocol/common/ping_job.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/devices/ping360/config.hpp"

namespace sonard::server {

/// Renderer settings of one ping: the head's acoustics with the bins of the job, the range cell of its pulse
/// at the true speed of sound, and the gain moved by the job's.
render::SonarSettings ping360_sonar_settings(const PingJob& job, const HeadConfig& head);

}  // namespace sonard::server
