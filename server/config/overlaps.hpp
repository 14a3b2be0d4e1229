// SPDX-License-Identifier: Apache-2.0
// Values that two heads, or a head and a pose input, must not share.
#pragma once

#include <vector>

#include "server/config/config.hpp"
#include "server/heads/head_type.hpp"
#include "server/yaml/config_error.hpp"

namespace sonard::server {

/// Sockets of the pose inputs and the page, then of each head; keys are paths in the whole configuration.
std::vector<PlannedSocket> planned_sockets(const DaemonConfig& config);

/// Sockets that conflict, duplicate names, and values that two heads of a type must not share.
std::vector<ConfigProblem> find_overlaps(const DaemonConfig& config, const KeyPositions& positions);

}  // namespace sonard::server
