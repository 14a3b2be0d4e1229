// The one place that knows both a Micron ping and the renderer's settings.
#pragma once

#include "protocol/micron/micron_job.hpp"
#include "renderer/pose.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/config/config.hpp"

namespace sonard::server {

/// Renderer settings of one ping: the head's acoustics with the bins of the job, the range cell of its chirp
/// at the true speed of sound, and the gain moved by as much as the client's is off the nominal one.
render::SonarSettings to_sonar_settings(const micron::MicronJob& job, const MicronHeadConfig& head);

/// The transducer at the bearing of a job: the mount, turned about its z axis.
render::Pose T_world_transducer(const render::Pose& T_world_mount, const micron::MicronJob& job);

}  // namespace sonard::server
