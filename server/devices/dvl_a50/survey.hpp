// SPDX-License-Identifier: Apache-2.0
// The pings of a DVL along a trajectory: the ranges of its beams, as of a device at rest.
#pragma once

#include <memory>

#include "server/devices/survey.hpp"
#include "server/heads/head_config.hpp"

namespace sonard::server {

/// @throws CLI::ValidationError
std::unique_ptr<Survey> survey_of_dvl(const HeadConfig& head, const SurveyOptions& options);

}  // namespace sonard::server
