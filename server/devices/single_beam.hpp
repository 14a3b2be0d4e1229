// SPDX-License-Identifier: Apache-2.0
// Renderer settings of a head with one beam, whose one transducer sends and receives.
#pragma once

#include "protocol/common/ping_job.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/heads/head_config.hpp"

namespace sonard::server {

/// Acoustics with a beam of these widths (-3 dB, degrees), and without effects that only arrays have.
render::SonarSettings single_beam_acoustics(double width_deg, double height_deg);

/// The head's acoustics with the bins and the transmission of a job.
render::SonarSettings single_beam_settings(const PingJob& job, const HeadConfig& head);

}  // namespace sonard::server
