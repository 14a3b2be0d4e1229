// SPDX-License-Identifier: Apache-2.0
// The sweeps of a Micron along a trajectory.
#pragma once

#include <memory>

#include "server/devices/survey.hpp"
#include "server/heads/head_config.hpp"

namespace sonard::server {

/// Applies the user's settings as a client would: through a head command and the head's job for a line. A
/// frame is a turn, or a sweep of the sector from one limit to the other. Only whole frames count.
/// @throws CLI::ValidationError
std::unique_ptr<Survey> survey_of_micron(const HeadConfig& head, const SurveyOptions& options);

}  // namespace sonard::server
