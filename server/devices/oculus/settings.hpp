// SPDX-License-Identifier: Apache-2.0
// Maps a ping of an Oculus to the renderer's settings. Only this file uses both.
#pragma once

#include "protocol/common/ping_job.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/devices/oculus/config.hpp"

namespace sonard::server {

/// Renderer settings of one ping.
/// @return the acoustics of the head at the frequency of the job, with the job's beams
/// (protocol/oculus/README.md 4.5, 8), rows, sample width, gamma and gain
render::SonarSettings oculus_sonar_settings(const PingJob& job, const HeadConfig& head);

}  // namespace sonard::server
