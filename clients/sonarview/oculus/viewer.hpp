// SPDX-License-Identifier: Apache-2.0
// The main loop of `sonarview oculus`.
#pragma once

#include "clients/sonarview/common/exit_status.hpp"
#include "clients/sonarview/oculus/options.hpp"

namespace sonard::client {

/// Runs until a limit of `options` or a signal.
/// @throws std::exception, whose what() is shown to the user
ExitStatus view_oculus(const OculusOptions& options);

}  // namespace sonard::client
