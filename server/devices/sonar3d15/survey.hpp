// SPDX-License-Identifier: Apache-2.0
// The shots of a Sonar 3D-15 along a trajectory.
#pragma once

#include <memory>

#include "server/devices/survey.hpp"
#include "server/heads/head_config.hpp"

namespace sonard::server {

/// @throws CLI::ValidationError
std::unique_ptr<Survey> survey_of_sonar3d15(const HeadConfig& head, const SurveyOptions& options);

}  // namespace sonard::server
