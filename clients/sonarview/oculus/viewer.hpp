// SPDX-License-Identifier: Apache-2.0
// The loop of `sonarview oculus`.
#pragma once

#include "clients/sonarview/common/exit_status.hpp"
#include "clients/sonarview/oculus/options.hpp"

namespace sonard::client {

/// Runs until the options or a signal end it.
/// @throws std::exception, whose what() is for the user
ExitStatus view_oculus(const OculusOptions& options);

}  // namespace sonard::client
