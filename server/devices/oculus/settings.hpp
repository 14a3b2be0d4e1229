// SPDX-License-Identifier: Apache-2.0
// The one place that knows both a ping of an Oculus and the renderer's settings.
#pragma once

#include "protocol/common/ping_job.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/devices/oculus/config.hpp"

namespace sonard::server {

/// Renderer settings of one ping.
/// @return the acoustics of the head at the frequency of the job, with its beams
///   (docs/protocols/oculus.md 4.5, 8), rows, width of samples and gamma, and the gain moved by the job's
render::SonarSettings oculus_sonar_settings(const PingJob& job, const HeadConfig& head);

}  // namespace sonard::server
