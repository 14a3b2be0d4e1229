// SPDX-License-Identifier: Apache-2.0
// The one place that knows both a ping of a Micron and the renderer's settings.
#pragma once

#include "protocol/common/ping_job.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/devices/micron/config.hpp"

namespace sonard::server {

/// Renderer settings of one ping: the head's acoustics with the bins of the job, the range cell of its chirp
/// at the true speed of sound, and the gain moved by as much as the client's is off the nominal one.
render::SonarSettings micron_sonar_settings(const PingJob& job, const HeadConfig& head);

}  // namespace sonard::server
