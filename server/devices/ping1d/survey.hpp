// SPDX-License-Identifier: Apache-2.0
// The pings of a Ping1D along a trajectory.
#pragma once

#include <memory>

#include "server/devices/survey.hpp"
#include "server/heads/head_config.hpp"

namespace sonard::server {

/// Applies the user's settings as a client would in manual mode. A frame is one ping, with the samples from
/// which the head makes its profile.
/// @throws CLI::ValidationError
std::unique_ptr<Survey> survey_of_ping1d(const HeadConfig& head, const SurveyOptions& options);

}  // namespace sonard::server
