// SPDX-License-Identifier: Apache-2.0
// The pings of a Gemini along a trajectory.
#pragma once

#include <memory>

#include "server/devices/survey.hpp"
#include "server/heads/head_config.hpp"

namespace sonard::server {

/// Applies the user's settings as a client would: through a ping configuration and the head's plan of it. A
/// frame is a ping, and has its number.
/// @throws CLI::ValidationError
std::unique_ptr<Survey> survey_of_gemini(const HeadConfig& head, const SurveyOptions& options);

}  // namespace sonard::server
