// The one place that knows both a Gemini ping and the renderer's settings.
#pragma once

#include "protocol/gemini/device.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/config/config.hpp"

namespace sonard::server {

/// Renderer settings of one ping.
/// @return the acoustics of the head with the beams of a 720i (docs/protocols/gemini.md 6.5) as the water
///   steers them, the range lines, the sample size and the length of the pulse of the job, and the gain moved
///   by the job's. A head that only listens hears no echo.
render::SonarSettings to_sonar_settings(const gemini::PingJob& job, const GeminiHeadConfig& head);

}  // namespace sonard::server
